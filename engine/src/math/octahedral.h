// Unit vectors in a few bits: the sphere, projected onto the octahedron |x| + |y| + |z| = 1, whose lower half is folded out around
// the upper one into a square, and the square's coordinates rounded.
//
// [Cigolle14] Z. Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors", JCGT 3(2), 2014.
#pragma once

#include <cmath>
#include <cstdint>

#include "math/vec.h"

namespace fluxfarm {

// `v` in 2 * kBits bits, kBits <= 16. Off by at most 4.3 / (2^kBits - 2) rad.
template <int kBits>
std::uint32_t to_octahedral(Vec3f v) {
  // An even number of steps, so that the axes are hit exactly.
  constexpr float kSteps = static_cast<float>((1u << kBits) - 2);
  const float scale = 1 / (std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z));
  float x = v.x * scale, y = v.y * scale;
  if (v.z < 0) {
    const float folded = std::copysign(1 - std::fabs(y), x);
    y = std::copysign(1 - std::fabs(x), y);
    x = folded;
  }
  // From [-1, 1] to the nearest of 0 ... kSteps: half a step is added before the fraction is cut off.
  constexpr float kHalf = 0.5f * kSteps;
  const auto step = [&](float coordinate) { return static_cast<std::uint32_t>(coordinate * kHalf + (kHalf + 0.5f)); };
  return step(x) << kBits | step(y);
}

// In the direction of what to_octahedral() was given, on the octahedron: between 0.577 and 1 long.
template <int kBits>
Vec3f from_octahedral(std::uint32_t bits) {
  constexpr float kStep = 2.0f / static_cast<float>((1u << kBits) - 2);
  constexpr std::uint32_t kMask = (1u << kBits) - 1;
  const float x = static_cast<float>(static_cast<std::int32_t>(bits >> kBits & kMask)) * kStep - 1;
  const float y = static_cast<float>(static_cast<std::int32_t>(bits & kMask)) * kStep - 1;
  const float z = 1 - std::fabs(x) - std::fabs(y);
  const float fold = std::max(-z, 0.0f);  // below the equator
  return {x - std::copysign(fold, x), y - std::copysign(fold, y), z};
}

}  // namespace fluxfarm
