// How good a cache has to be for the samples that use it.
//
// The samples of a pixel fall into levels: 0 to 15, 16 to 63, 64 to 255 and so on, and each level has a cache of its own, with
// twice the paths in a record and half the tolerance of the last but one. So a picture has as much of a cache as its goal needs,
// and as samples are added its error goes to zero: by noise of records and by interpolation.
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

inline CacheQuality quality_of(SampleRange level) {
  constexpr float kFirstPaths = 256, kFirstTolerance = 0.15f;  // choices
  // 1, 2, 4, ... for one level after the other.
  const float growth = std::pow(static_cast<float>(level.end) / static_cast<float>(kFirstCacheLevel), 1.0f / 3);
  const int replicate_side = static_cast<int>(std::ceil(std::sqrt(kFirstPaths * growth) / static_cast<float>(kReplicates)));
  const float tolerance = kFirstTolerance / growth;
  // A turn by t brings light of the horizon in and out: t^2 / 4 of all, if it is even.
  return {.strata = static_cast<int>(kReplicates) * replicate_side, .tolerance = tolerance, .max_angle = 2 * std::sqrt(tolerance)};
}

}  // namespace fluxfarm
