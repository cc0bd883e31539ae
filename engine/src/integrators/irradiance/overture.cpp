#include "integrators/irradiance/overture.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "integrators/irradiance/cached_irradiance.h"
#include "integrators/irradiance/hemisphere_sampler.h"
#include "sampling/hash.h"
#include "support/error.h"
#include "support/parallel.h"

namespace fluxfarm {
namespace {

// Choices. Records that are used so near that they cover few pixels cost more than the paths that they spare.
constexpr float kLeastRoom = 0.4f;    // distance of what is nearest, over the side of what a pixel sees: nearer ones are not tried
constexpr float kLeastRadius = 1.5f;  // of a record, over the side of what a pixel sees
constexpr float kRefusedRadius = 3;   // the same, of the place around a refused one where no other is tried
constexpr float kLargestRadius = 0.2f;  // over that of the scene
constexpr int kMaxSurfaces = 16;        // on the way to a diffuse one
constexpr std::size_t kPixelsAtOnce = 64;
// relMSE divides by the square of a radiance plus 0.01: irradiance that makes 0.1 on a white surface.
constexpr float kLeastIrradiance = 0.1f * kPi;  // W m^-2

class OvertureBuilder {
 public:
  OvertureBuilder(const Scene& scene, const CausticMaps* caustics, std::uint64_t seed, const CacheQuality& quality, int threads,
                  const std::atomic<bool>& cancelled)
      : scene_(scene), seed_(seed), quality_(quality), threads_(threads), cancelled_(cancelled) {
    for (int i = 0; i < threads; ++i) workers_.emplace_back(std::make_unique<Worker>(scene, caustics));
  }

  Overture build() {
    const FilmDescription& film = scene_.film();
    int step = 1;
    while (step < std::max(film.width, film.height)) step *= 2;
    for (; step > 0; step /= 2) refine(step);
    Overture overture{std::move(cache_), 0};
    for (const auto& worker : workers_) overture.rays += worker->queries.rays();
    return overture;
  }

 private:
  struct Worker {
    Worker(const Scene& scene, const CausticMaps* caustics)
        : queries(scene.accelerator()), sampler(make_hemisphere_sampler(scene, caustics, queries)) {}
    RayQueries queries;
    std::unique_ptr<HemisphereSampler> sampler;
  };

  void check_cancelled() const {
    if (cancelled_.load(std::memory_order_relaxed)) throw CancelledError();
  }

  // Looks at one pixel in step x step.
  void refine(int step) {
    const FilmDescription& film = scene_.film();
    const int columns = (film.width + step - 1) / step, rows = (film.height + step - 1) / step;
    std::vector<std::optional<GatherPlace>> found(static_cast<std::size_t>(columns) * rows);
    parallel_for((found.size() + kPixelsAtOnce - 1) / kPixelsAtOnce, threads_, [&](std::size_t group, int thread) {
      check_cancelled();
      prepare_render_thread();
      for (std::size_t i = group * kPixelsAtOnce; i < std::min(found.size(), (group + 1) * kPixelsAtOnce); ++i) {
        const int column = static_cast<int>(i) % columns, row = static_cast<int>(i) / columns;
        // Anywhere in the step's square, so that no two caches have records at the same places.
        const std::uint64_t bits = hash_words(seed_, step, i);
        const auto mask = static_cast<std::uint64_t>(step - 1);
        const int x = std::min(column * step + static_cast<int>(bits & mask), film.width - 1),
                  y = std::min(row * step + static_cast<int>(bits >> 32 & mask), film.height - 1);
        found[i] = uncovered_place(x, y, static_cast<std::uint32_t>(step), workers_[static_cast<std::size_t>(thread)]->queries);
      }
    });
    std::vector<GatherPlace> places;
    for (const std::optional<GatherPlace>& place : found) {
      if (place) places.push_back(*place);
    }
    if (places.empty()) return;
    std::vector<Made> made(places.size());
    const int first = static_cast<int>(tried_);
    parallel_for(places.size(), threads_, [&](std::size_t i, int thread) {
      check_cancelled();
      prepare_render_thread();
      made[i] = make(places[i], first + static_cast<int>(i), *workers_[static_cast<std::size_t>(thread)]);
    });
    tried_ += places.size();
    for (const Made& m : made) (m.kept ? records_ : refused_records_).push_back(m.record);
    cache_ = IrradianceCache(records_, quality_.max_angle);
    refused_ = IrradianceCache(refused_records_, quality_.max_angle);
  }

  // Where the path through a pixel comes to a surface that takes irradiance, if no record covers that and none was refused there.
  std::optional<GatherPlace> uncovered_place(int x, int y, std::uint32_t step, RayQueries& queries) const {
    const CameraSample sample{x, y, 0};
    SamplerBatch sampler;
    std::array<Ray, kMaxPaths> rays;
    start_camera_rays(scene_, {&sample, 1}, hash_words(seed_, step), sampler, rays);
    std::array<Vec2f, kMaxPaths> u;
    Ray ray = rays[0];
    float length = 0;
    const int max_depth = scene_.method().max_depth < 0 ? std::numeric_limits<int>::max() : scene_.method().max_depth;
    for (int depth = 0; depth < std::min(kMaxSurfaces, max_depth - 1); ++depth) {
      Hit hit;
      queries.intersect({&ray, 1}, {&hit, 1}, false);
      if (hit.shape == Hit::kNone) return std::nullopt;
      BsdfSpace space;
      const PathVertex vertex(scene_, ray, hit, space);
      length += hit.t;
      if (takes_irradiance(*vertex.surface)) {
        if (!(vertex.wo.z > 0) || vertex.bsdf->albedo(vertex.wo).is_black()) return std::nullopt;
        const ReceivingPlace receiving = receiving_place(vertex, max_depth - depth);
        if (cache_.covers(receiving) || refused_.covers(receiving)) return std::nullopt;
        return GatherPlace{vertex.point.position, vertex.frame, vertex.origin_towards(vertex.frame.n), depth,
                           receiving.room,        length};
      }
      sampler.draw_2d(dimension_of(depth, kDirection), u);
      const std::optional<BsdfSample> scatter =
          vertex.bsdf->sample(vertex.wo, sampler.draw_1d(dimension_of(depth, kLobe), 0), u[0]);
      if (!scatter || !scatter->delta) return std::nullopt;
      const Vec3f direction = vertex.frame.to_world(scatter->wi);
      ray = {vertex.origin_towards(direction), direction};
    }
    return std::nullopt;
  }

  struct Made {
    IrradianceRecord record;
    bool kept = false;
  };
  Made make(const GatherPlace& place, int index, Worker& worker) const {
    const float footprint = scene_.camera().pixel_angle() * place.length, least = kLeastRadius * footprint;
    const RecordLimits limits{quality_.tolerance, kLeastIrradiance, kLargestRadius * scene_.radius()};
    const RecordLimits refused{quality_.tolerance, kLeastIrradiance, kRefusedRadius * footprint};
    const float far = 1e3f * scene_.radius();
    const auto refuse = [&] {
      HemisphereIrradiance flat;
      flat.irradiance = Rgb{1};
      return Made{IrradianceRecord(place.position, place.frame, place.room, flat, refused), false};
    };
    if (least_distance(place, worker.queries) < kLeastRoom * footprint) return refuse();
    HemisphereGrid grid(quality_.strata, far);
    worker.sampler->gather(place, seed_, index, grid);
    const IrradianceRecord record(place.position, place.frame, place.room, grid.irradiance(), limits);
    if (!(record.larger_radius() * record.smaller_radius() >= least * least)) return refuse();
    return {record, true};
  }

  const Scene& scene_;
  std::uint64_t seed_;
  CacheQuality quality_;
  int threads_;
  const std::atomic<bool>& cancelled_;
  std::vector<std::unique_ptr<Worker>> workers_;
  std::vector<IrradianceRecord> records_, refused_records_;
  IrradianceCache cache_, refused_;
  std::size_t tried_ = 0;
};

}  // namespace

Overture make_overture(const Scene& scene, const CausticMaps* caustics, std::uint64_t seed, const CacheQuality& quality,
                       int threads, const std::atomic<bool>& cancelled) {
  return OvertureBuilder(scene, caustics, seed, quality, threads, cancelled).build();
}

}  // namespace fluxfarm
