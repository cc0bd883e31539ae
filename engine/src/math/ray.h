// A ray with its valid interval, and the offset that keeps a new ray off the surface it leaves.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "math/vec.h"

namespace fluxfarm {

struct Ray {
  Vec3f origin;
  Vec3f direction;  // unit length unless said otherwise
  float t_min = 0;
  float t_max = std::numeric_limits<float>::infinity();
};

// `p` on a surface moved to the side that `normal` (unit, geometric) points to, by an amount in proportion to the rounding of
// its coordinates, so that it works at every scale of scene.
// [Waechter19] C. Waechter and N. Binder, "A Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems, ch. 6.
inline Vec3f offset_point(Vec3f p, Vec3f normal) {
  constexpr float kNearOrigin = 1.0f / 32, kFloatScale = 1.0f / 65536, kIntScale = 256;
  // Both answers are computed and one is taken: a choice costs less than a branch that guesses wrong.
  const auto axis = [](float value, float n) {
    const auto bits = std::bit_cast<std::int32_t>(value);
    const auto steps = static_cast<std::int32_t>(kIntScale * n);
    const std::int32_t sign = bits >> 31;  // 0 or -1
    const std::int32_t far = bits + ((steps ^ sign) - sign);
    const std::int32_t near = std::bit_cast<std::int32_t>(value + kFloatScale * n);
    const std::int32_t is_near = -static_cast<std::int32_t>(std::fabs(value) < kNearOrigin);
    return std::bit_cast<float>((near & is_near) | (far & ~is_near));
  };
  return {axis(p.x, normal.x), axis(p.y, normal.y), axis(p.z, normal.z)};
}

}  // namespace fluxfarm
