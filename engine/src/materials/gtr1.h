// Distribution of microfacet normals with a long tail, for clear coats: generalised Trowbridge-Reitz with exponent one.
//
// [Burley12] B. Burley, "Physically-Based Shading at Disney", SIGGRAPH 2012 course notes, appendix B.
#pragma once

#include <cmath>

#include "math/vec.h"

namespace fluxfarm {

class Gtr1 {
 public:
  // alpha in (0, 1).
  explicit Gtr1(float alpha) : alpha2_(alpha * alpha), log_alpha2_(std::log(alpha2_)) {}

  // D(m), per steradian and unit of macroscopic area; D(m) m.z integrates to one.
  float normal_density(Vec3f m) const {
    const float sin2 = m.x * m.x + m.y * m.y;  // keeps its digits near the axis, where 1 - cos^2 has none
    return (alpha2_ - 1) / (kPi * log_alpha2_ * (sin2 + alpha2_ * m.z * m.z));
  }

  // A normal in proportion to D(m) m.z, of all normals and not only those that some direction sees.
  Vec3f sample_normal(Vec2f u) const {
    const float sin2 = (std::exp(log_alpha2_ * (1 - u.y)) - alpha2_) / (1 - alpha2_);
    const float r = safe_sqrt(sin2), angle = kTwoPi * u.x;
    return {r * std::cos(angle), r * std::sin(angle), safe_sqrt(1 - sin2)};
  }

 private:
  float alpha2_, log_alpha2_;
};

}  // namespace fluxfarm
