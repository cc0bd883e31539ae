// The affine map that a texture applies to texture coordinates.
#pragma once

#include "math/transform.h"
#include "math/vec.h"

namespace fluxfarm {

class UvMap {
 public:
  // The part of a spatial transform that moves (u, v, 0) within its plane, as in Mitsuba.
  explicit UvMap(const Transform& to_uv) {
    const auto& m = to_uv.matrix();
    for (std::size_t row = 0; row < 2; ++row) {
      rows_[row][0] = static_cast<float>(m[row][0]);
      rows_[row][1] = static_cast<float>(m[row][1]);
      rows_[row][2] = static_cast<float>(m[row][3]);
    }
  }

  Vec2f operator()(Vec2f uv) const {
    return {rows_[0][0] * uv.x + rows_[0][1] * uv.y + rows_[0][2], rows_[1][0] * uv.x + rows_[1][1] * uv.y + rows_[1][2]};
  }

  // A gradient by the mapped coordinates becomes one by u and v: the transposed linear part.
  Vec2f gradient(Vec2f g) const { return {rows_[0][0] * g.x + rows_[1][0] * g.y, rows_[0][1] * g.x + rows_[1][1] * g.y}; }

 private:
  float rows_[2][3];
};

// u - floor(u), in [0,1]: 1 when rounding makes it so, 0 where u is too large to have a fraction.
inline float fraction(float u) {
  const float f = u - std::floor(u);
  return f >= 0 && f <= 1 ? f : 0.0f;
}

}  // namespace fluxfarm
