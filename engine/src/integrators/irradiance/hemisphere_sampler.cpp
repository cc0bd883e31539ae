#include "integrators/irradiance/hemisphere_sampler.h"

#include <algorithm>
#include <array>
#include <limits>

#include "integrators/irradiance/cached_irradiance.h"
#include "integrators/path/path_group.h"
#include "integrators/photon/caustic_photons.h"
#include "sampling/warp.h"

namespace fluxfarm {
namespace {

// Paths that tell on their way how far their first surface is.
template <typename Photons>
class FirstDistance : public Photons {
 public:
  explicit FirstDistance(Photons photons) : Photons(std::move(photons)) {}

  struct State {
    typename Photons::State photons;
    float* distance = nullptr;  // to be told; null: it has been
  };
  // Of a path that the diffuse surface of `place` scattered.
  State start(const GatherPlace& place, std::uint32_t replicate, float& distance) const {
    State state{Photons::start({0, 0, replicate}), &distance};
    Photons::arrive(state.photons, place.length);
    Photons::scatter(state.photons, {.wi = {0, 0, 1}, .weight = Rgb{1}, .pdf = kInvPi});
    return state;
  }
  void arrive(State& state, float distance) const {
    if (state.distance != nullptr) *state.distance = distance;
    state.distance = nullptr;
    Photons::arrive(state.photons, distance);
  }
  bool ended(const State& state) const { return Photons::ended(state.photons); }
  void gather(State& state, const PathVertex& vertex, int room, const Rgb& throughput, const LightHistory& history,
              SampleResult& result) {
    Photons::gather(state.photons, vertex, room, throughput, history, result);
  }
  void scatter(State& state, const BsdfSample& sample) const { Photons::scatter(state.photons, sample); }
  float left_of_map(const State& state, Vec3f direction) const { return Photons::left_of_map(state.photons, direction); }
  float left_of_constant(const State& state) const { return Photons::left_of_constant(state.photons); }
  float left_of_found(const State& state, const AreaEmitter& emitter, const SurfacePoint& point, Vec3f direction) const {
    return Photons::left_of_found(state.photons, emitter, point, direction);
  }
  float left_of_asked(const State& state, const Rgb& f, const Emitter& emitter, const EmitterSample& light) const {
    return Photons::left_of_asked(state.photons, f, emitter, light);
  }
};

template <typename Photons>
class PathSampler final : public HemisphereSampler {
 public:
  PathSampler(const Scene& scene, Photons photons, RayQueries& queries)
      : tells_(photons), paths_(scene, FirstDistance<Photons>(std::move(photons)), queries) {}

  void gather(const GatherPlace& place, std::uint64_t seed, int place_index, HemisphereGrid& grid) override {
    std::array<Ray, kMaxPaths> rays;
    std::array<typename FirstDistance<Photons>::State, kMaxPaths> states;
    std::array<SampleResult, kMaxPaths> results;
    std::array<Vec2f, kMaxPaths> u;
    SamplerBatch sampler;
    for (std::size_t begin = 0; begin < grid.size(); begin += kMaxPaths) {
      const std::size_t count = std::min(kMaxPaths, grid.size() - begin);
      sampler.clear();
      for (std::size_t i = begin; i < begin + count; ++i) {
        // The sampler's replicate of a stratum is the grid's.
        sampler.add(seed, place_index, 0, static_cast<std::uint32_t>(i / kReplicates * kReplicates) + grid.replicate(i));
      }
      sampler.draw_2d(dimension_of(place.depth, kDirection), u);
      for (std::size_t i = 0; i < count; ++i) {
        GatheredLight& light = grid.light(begin + i);
        light.direction = square_to_cosine_hemisphere(grid.place(begin + i, u[i]));
        light.distance = std::numeric_limits<float>::infinity();
        rays[i] = {place.origin, place.frame.to_world(light.direction)};
        states[i] = tells_.start(place, grid.replicate(begin + i), light.distance);
        results[i] = {};
      }
      const EmitterReference reference{place.position, place.frame.n, false};
      paths_.trace_gathered({rays.data(), count}, {states.data(), count}, reference, place.depth + 1, sampler,
                            {results.data(), count});
      for (std::size_t i = 0; i < count; ++i) grid.light(begin + i).radiance = results[i].radiance;
    }
  }

 private:
  FirstDistance<Photons> tells_;
  PathGroup<FirstDistance<Photons>> paths_;
};

}  // namespace

std::unique_ptr<HemisphereSampler> make_hemisphere_sampler(const Scene& scene, const CausticMaps* caustics,
                                                           const IrradianceCache* known, RayQueries& queries) {
  const auto make = [&]<typename Photons>(Photons photons) -> std::unique_ptr<HemisphereSampler> {
    if (known == nullptr) return std::make_unique<PathSampler<Photons>>(scene, std::move(photons), queries);
    using Cached = CachedIrradiance<Photons>;
    return std::make_unique<PathSampler<Cached>>(scene, Cached(*known, std::move(photons)), queries);
  };
  return caustics == nullptr ? make(WithoutPhotons()) : make(CausticPhotons(scene, *caustics));
}

std::optional<Vec3f> nearest_point(const GatherPlace& place, RayQueries& queries) {
  constexpr std::size_t kSide = 8;
  static_assert(kSide * kSide <= kMaxPaths);
  std::array<Vec3f, kSide * kSide> directions;
  std::array<Ray, kSide * kSide> rays;
  std::array<Hit, kSide * kSide> hits;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::size_t column = i % kSide, row = i / kSide;
    const Vec2f u{(static_cast<float>(column) + 0.5f) / kSide, (static_cast<float>(row) + 0.5f) / kSide};
    directions[i] = square_to_cosine_hemisphere(u);
    rays[i] = {place.origin, place.frame.to_world(directions[i])};
  }
  queries.intersect(rays, hits, false);
  float least = std::numeric_limits<float>::infinity();
  std::optional<Vec3f> nearest;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (hits[i].shape == Hit::kNone || !(hits[i].t < least)) continue;
    least = hits[i].t;
    nearest = directions[i] * least;
  }
  return nearest;
}

}  // namespace fluxfarm
