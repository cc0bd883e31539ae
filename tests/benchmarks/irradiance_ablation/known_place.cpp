#include "known_place.h"

#include <limits>
#include <memory>

#include "integrators/irradiance/cached_irradiance.h"
#include "support/parallel.h"

namespace fluxfarm::ablation {
namespace {

class Gatherer {
 public:
  Gatherer(const Scene& scene, int strata)
      : scene_(scene),
        queries_(scene.accelerator()),
        sampler_(make_hemisphere_sampler(scene, nullptr, nullptr, queries_)),
        grid_(strata, 1e3f * scene.radius()) {}

  std::array<float, 2> halves(const GatherPlace& place, std::uint64_t seed, std::size_t index) {
    sampler_->gather(place, seed, static_cast<int>(index), grid_);
    std::array<float, 2> halves{};
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      halves[grid_.replicate(i) % 2] += luminance(grid_.light(i).radiance) * (2 * kPi / static_cast<float>(grid_.size()));
    }
    return halves;
  }

  KnownPlace know(const GatherPlace& place, std::uint64_t seed, std::size_t index) {
    KnownPlace known;
    known.place = place;
    known.pixel_m = scene_.camera().pixel_angle() * place.length;
    known.by_half = halves(place, seed, index);
    known.irradiance = (known.by_half[0] + known.by_half[1]) / 2;
    const HemisphereIrradiance light = grid_.irradiance();
    known.turned_x = luminance(light.turned_x);
    known.turned_y = luminance(light.turned_y);
    known.occlusion_gradient = {luminance(light.gradient_x), luminance(light.gradient_y)};
    known.occlusion_hessian = light.hessian;
    std::vector<GatheredLight> lights;
    lights.reserve(grid_.size());
    for (std::size_t i = 0; i < grid_.size(); ++i) lights.push_back(grid_.light(i));
    known.cell_gradient = cell_gradient(lights);
    known.harmonic_mean_m = harmonic_mean_distance(lights);
    known.geometric_hessian = geometric_hessian(place, lights);
    return known;
  }

 private:
  // Meets the first surfaces again for their normals.
  GeometricHessian geometric_hessian(const GatherPlace& place, const std::vector<GatheredLight>& lights) {
    GeometricHessian hessian;
    for (std::size_t begin = 0; begin < lights.size(); begin += kMaxPaths) {
      const std::size_t count = std::min(kMaxPaths, lights.size() - begin);
      std::array<Ray, kMaxPaths> rays;
      std::array<Hit, kMaxPaths> hits;
      for (std::size_t i = 0; i < count; ++i) rays[i] = {place.origin, place.frame.to_world(lights[begin + i].direction)};
      queries_.intersect({rays.data(), count}, {hits.data(), count}, false);
      for (std::size_t i = 0; i < count; ++i) {
        if (hits[i].shape == Hit::kNone) continue;
        const Vec3f there = scene_.surface(hits[i].shape).shape->surface_point(rays[i], hits[i]).geometric_normal;
        const Vec3f normal = place.frame.to_local(dot(there, rays[i].direction) > 0 ? -there : there);
        hessian.add(patch_hessian(lights[begin + i].direction, hits[i].t, normal), 1 / static_cast<double>(lights.size()));
      }
    }
    return hessian;
  }

  const Scene& scene_;
  RayQueries queries_;
  std::unique_ptr<HemisphereSampler> sampler_;
  HemisphereGrid grid_;
};

// make(gatherer, index of the place) for all places, side by side.
template <typename Made, typename Make>
std::vector<Made> make_all(const Scene& scene, std::size_t places, int strata, int threads, const Make& make) {
  std::vector<std::unique_ptr<Gatherer>> gatherers;
  for (int i = 0; i < threads; ++i) gatherers.push_back(std::make_unique<Gatherer>(scene, strata));
  std::vector<Made> all(places);
  parallel_for(places, threads, [&](std::size_t i, int thread) {
    prepare_render_thread();
    all[i] = make(*gatherers[static_cast<std::size_t>(thread)], i);
  });
  return all;
}

}  // namespace

std::vector<GatherPlace> seen_places(const Scene& scene) {
  std::vector<GatherPlace> places;
  RayQueries queries(scene.accelerator());
  const FilmDescription& film = scene.film();
  const int room = scene.method().max_depth < 0 ? std::numeric_limits<int>::max() : scene.method().max_depth;
  for (int y = 0; y < film.height; ++y) {
    for (int x = 0; x < film.width; ++x) {
      const Ray ray = scene.camera().ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      Hit hit;
      queries.intersect({&ray, 1}, {&hit, 1}, false);
      if (hit.shape == Hit::kNone) continue;
      BsdfSpace space;
      const PathVertex vertex(scene, ray, hit, space);
      if (!takes_irradiance(*vertex.surface) || !(vertex.wo.z > 0) || vertex.bsdf->albedo(vertex.wo).is_black()) continue;
      places.push_back({vertex.point.position, vertex.frame, vertex.origin_towards(vertex.frame.n), 0,
                        receiving_place(vertex, room).room, hit.t});
    }
  }
  return places;
}

std::vector<KnownPlace> gather_all(const Scene& scene, const std::vector<GatherPlace>& places, int strata, std::uint64_t seed,
                                   int threads) {
  return make_all<KnownPlace>(scene, places.size(), strata, threads,
                              [&](Gatherer& gatherer, std::size_t i) { return gatherer.know(places[i], seed, i); });
}

std::vector<std::array<float, 2>> reference(const Scene& scene, const std::vector<GatherPlace>& places, int strata,
                                            std::uint64_t seed, int threads) {
  return make_all<std::array<float, 2>>(scene, places.size(), strata, threads,
                                        [&](Gatherer& gatherer, std::size_t i) { return gatherer.halves(places[i], seed, i); });
}

}  // namespace fluxfarm::ablation
