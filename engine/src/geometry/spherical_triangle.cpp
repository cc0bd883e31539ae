#include "geometry/spherical_triangle.h"

#include <algorithm>
#include <cmath>

namespace fluxfarm {
namespace {

// The part of v at right angles to the unit vector n, with unit length.
Vec3f orthogonal_part(Vec3f v, Vec3f n) { return normalize(v - dot(v, n) * n); }

}  // namespace

SphericalTriangle::SphericalTriangle(Vec3f a, Vec3f b, Vec3f c, Vec3f reference)
    : a_(normalize(a - reference)), b_(normalize(b - reference)), c_(normalize(c - reference)) {
  // A. van Oosterom and J. Strackee, "The Solid Angle of a Plane Triangle", IEEE Trans. Biomed. Eng. 30(2), 1983.
  const float volume = std::fabs(dot(a_, cross(b_, c_)));
  solid_angle_ = 2 * std::atan2(volume, 1 + dot(a_, b_) + dot(b_, c_) + dot(c_, a_));
  cos_alpha_ = std::clamp(dot(orthogonal_part(b_, a_), orthogonal_part(c_, a_)), -1.0f, 1.0f);
  sin_alpha_ = safe_sqrt(1 - cos_alpha_ * cos_alpha_);
}

Vec3f SphericalTriangle::sample(Vec2f u) const {
  // The share u.x of the solid angle lies on one side of the arc from b to a new corner on the edge a c.          [Arvo95]
  const float part = u.x * solid_angle_;
  const float sin_part = std::sin(part), cos_part = std::cos(part);
  const float s = sin_part * cos_alpha_ - cos_part * sin_alpha_;  // sin(part - alpha)
  const float t = cos_part * cos_alpha_ + sin_part * sin_alpha_;  // cos(part - alpha)
  const float p = t - cos_alpha_;
  const float q = s + sin_alpha_ * dot(a_, b_);
  const float denominator = (q * s + p * t) * sin_alpha_;
  const float cos_edge = denominator != 0 ? std::clamp(((q * t - p * s) * cos_alpha_ - q) / denominator, -1.0f, 1.0f) : 1.0f;
  const Vec3f corner = cos_edge * a_ + safe_sqrt(1 - cos_edge * cos_edge) * orthogonal_part(c_, a_);
  // Along that arc: uniform in the cosine of the distance from b.
  const float z = 1 - u.y * (1 - dot(corner, b_));
  const Vec3f away = corner - dot(corner, b_) * b_;
  const float squared = length_squared(away);
  if (!(squared > 0)) return b_;
  return z * b_ + safe_sqrt(1 - z * z) * (away / std::sqrt(squared));
}

}  // namespace fluxfarm
