#include "integrators/irradiance/hemisphere_sampler.h"

#include <limits>

#include "sampling/warp.h"

namespace fluxfarm {

float HemisphereSampler::least_distance(const GatherPlace& place) const {
  constexpr std::size_t kSide = 8;
  static_assert(kSide * kSide <= kMaxPaths);
  std::array<Ray, kSide * kSide> rays;
  std::array<Hit, kSide * kSide> hits;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Vec2f u{(static_cast<float>(i % kSide) + 0.5f) / kSide, (static_cast<float>(i / kSide) + 0.5f) / kSide};
    rays[i] = {place.origin, place.frame.to_world(square_to_cosine_hemisphere(u))};
  }
  queries_.intersect(rays, hits, false);
  float least = std::numeric_limits<float>::infinity();
  for (const Hit& hit : hits) {
    if (hit.shape != Hit::kNone) least = std::min(least, hit.t);
  }
  return least;
}

void HemisphereSampler::gather(const GatherPlace& place, std::uint64_t seed, int place_index, HemisphereGrid& grid) {
  std::array<Ray, kMaxPaths> rays;
  std::array<FirstDistance::State, kMaxPaths> states;
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
      states[i] = {&light.distance};
      results[i] = {};
    }
    const EmitterReference reference{place.position, place.frame.n, false};
    paths_.trace_gathered({rays.data(), count}, {states.data(), count}, reference, place.depth + 1, sampler,
                          {results.data(), count});
    for (std::size_t i = 0; i < count; ++i) grid.light(begin + i).radiance = results[i].radiance;
  }
}

}  // namespace fluxfarm
