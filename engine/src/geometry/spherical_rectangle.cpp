#include "geometry/spherical_rectangle.h"

#include <algorithm>
#include <cmath>

namespace fluxfarm {

SphericalRectangle::SphericalRectangle(Vec3f s, Vec3f axis_x, Vec3f axis_y, float length_x, float length_y, Vec3f reference) {
  const Vec3f d = s - reference;
  z0_ = -std::fabs(dot(d, cross(axis_x, axis_y)));
  x0_ = dot(d, axis_x);
  y0_ = dot(d, axis_y);
  x1_ = x0_ + length_x;
  y1_ = y0_ + length_y;
  // z components of the normals of the four planes through the reference point and an edge. The normals of opposite edges share
  // the plane's other components, so the four inner angles come from these alone.                         [Urena13, section 4]
  const auto normal_z = [z = z0_](float e) { return e / std::sqrt(z * z + e * e); };
  const float n0 = -normal_z(y0_), n1 = normal_z(x1_), n2 = normal_z(y1_), n3 = -normal_z(x0_);
  const auto angle = [](float a, float b) { return std::acos(std::clamp(-a * b, -1.0f, 1.0f)); };
  const float g0 = angle(n0, n1), g1 = angle(n1, n2), g2 = angle(n2, n3), g3 = angle(n3, n0);
  b0_ = n0;
  b1_ = n2;
  k_ = kTwoPi - g2 - g3;
  solid_angle_ = g0 + g1 - k_;
}

Vec2f SphericalRectangle::sample(Vec2f u) const {
  // Column of directions: the share u.x of the solid angle lies to its left.
  const float au = u.x * solid_angle_ + k_;
  const float fu = (std::cos(au) * b0_ - b1_) / std::sin(au);
  const float cu = std::clamp(std::copysign(1 / std::sqrt(fu * fu + b0_ * b0_), fu), -1.0f, 1.0f);
  const float xu = std::clamp(-(cu * z0_) / std::max(std::sqrt(1 - cu * cu), 1e-7f), x0_, x1_);
  // Height within the column: uniform in the sine of elevation.
  const float d = std::sqrt(xu * xu + z0_ * z0_);
  const float h0 = y0_ / std::sqrt(d * d + y0_ * y0_);
  const float h1 = y1_ / std::sqrt(d * d + y1_ * y1_);
  const float hv = h0 + u.y * (h1 - h0);
  const float yv = hv * hv < 1 - 1e-6f ? std::clamp(hv * d / std::sqrt(1 - hv * hv), y0_, y1_) : y1_;
  return {xu - x0_, yv - y0_};
}

}  // namespace fluxfarm
