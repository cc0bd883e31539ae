// Axis-aligned box, and ball.
#pragma once

#include <limits>

#include "math/vec.h"

namespace fluxfarm {

// Default: empty.
struct Bounds {
  Vec3f lower{kInfinity, kInfinity, kInfinity};
  Vec3f upper{-kInfinity, -kInfinity, -kInfinity};

  void extend(Vec3f p) {
    lower = min(lower, p);
    upper = max(upper, p);
  }
  bool empty() const { return !(lower.x <= upper.x); }
  Vec3f center() const { return 0.5f * (lower + upper); }
  // Radius of the sphere around center() that holds the box; 0 when empty.
  float radius() const { return empty() ? 0.0f : 0.5f * length(upper - lower); }

 private:
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();
};

struct Ball {
  Vec3f center;
  float radius = 0;
};

}  // namespace fluxfarm
