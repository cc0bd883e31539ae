// How good a cache has to be for the samples that use it.
//
// The samples of a pixel fall into levels: 0 to 15, 16 to 127, 128 to 1023 and so on, and each level has a cache of its own, with
// half the tolerance of the last and more paths in a record, which end where the last level's cache knows the irradiance. So a
// picture has as much of a cache as its goal needs, and as samples are added its error goes to zero: by noise of records and by
// interpolation.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "film/pixel_rect.h"
#include "sampling/sampler.h"

namespace fluxfarm {

struct CacheQuality {
  int strata = 24;         // along a side of a record's hemisphere
  float tolerance = 0.1f;  // as RecordLimits
  float max_angle = 0.5f;  // between normals of a record and its use, rad
};

inline constexpr std::uint32_t kFirstCacheLevel = 16;  // samples in it

// The samples of the level to which those belong.
constexpr SampleRange cache_level(SampleRange samples) {
  SampleRange level{0, kFirstCacheLevel};
  while (samples.begin >= level.end) level = {level.end, 8 * level.end};
  return level;
}

// Of the next level over the one before: the rays that it takes, the second and later ones. Measured on our scenes
// (engine/docs/decisions/0012).
inline constexpr double kSecondLevelGrowth = 1.7, kNextLevelGrowth = 2.25;

inline CacheQuality quality_of(SampleRange level) {
  constexpr float kFirstSide = 16, kFirstTolerance = 0.15f;  // choices
  const float growth = static_cast<float>(level.end) / static_cast<float>(kFirstCacheLevel);
  // Twice the paths for eight times the samples, in strata of which each replicate has as many.
  const auto replicates = static_cast<float>(kReplicates);
  const int side =
      static_cast<int>(kReplicates) * static_cast<int>(std::lround(kFirstSide * std::pow(growth, 1.0f / 6) / replicates));
  const float tolerance = kFirstTolerance / std::cbrt(growth);
  // A turn by t brings light of the horizon in and out: t^2 / 4 of all, if it is even.
  return {.strata = side, .tolerance = tolerance, .max_angle = 2 * std::sqrt(tolerance)};
}

}  // namespace fluxfarm
