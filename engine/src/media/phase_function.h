// Scattering inside a medium: Henyey and Greenstein's phase function; asymmetry 0 is the isotropic one.
//
// Directions are those in which the path travels, world frame, unit: `along` arrives, `out` leaves, and g > 0 scatters forwards.
// The function is reciprocal and depends on the angle between the two alone.
//
// [Henyey41] L. G. Henyey and J. L. Greenstein, "Diffuse Radiation in the Galaxy", Astrophysical Journal 93, 1941.
#pragma once

#include <cmath>

#include "math/frame.h"
#include "math/vec.h"
#include "sampling/warp.h"

namespace fluxfarm {

class PhaseFunction {
 public:
  // `g`: mean cosine of the deflection, in (-1,1).
  explicit PhaseFunction(float g = 0) : g_(g) {}

  // Share of the scattered light that goes from `along` to `out`, sr^-1; at once the density of sample().        [Henyey41]
  float value(Vec3f along, Vec3f out) const {
    // 1 + g^2 - 2g cos, by the distance from the peak at `along` or, for g < 0, against it: the cosine has lost its digits there.
    const float size = std::fabs(g_);
    const float base = sqr(1 - size) + size * length_squared(g_ < 0 ? along + out : along - out);
    return (0.25f * kInvPi) * (1 - g_) * (1 + g_) / (base * std::sqrt(base));
  }

  // The largest value that it has.
  float peak() const {
    const float size = std::fabs(g_);
    return (0.25f * kInvPi) * (1 + size) / ((1 - size) * (1 - size));
  }

  // A direction to leave in, for u in [0,1)^2; its weight is one.
  Vec3f sample(Vec3f along, Vec2f u) const {
    // A point of the disk gives the azimuth, and its squared radius s a cosine w = 1 - 2s that is uniform in [-1,1].
    const Vec2f p = square_to_uniform_disk(u);
    const float s = std::min(p.x * p.x + p.y * p.y, 1.0f);
    const float versine = deflection_versine(s);  // 1 - cos
    const float sine_over_radius = s > 0 ? safe_sqrt(versine * (2 - versine) / s) : 0.0f;
    return Frame(along).to_world({p.x * sine_over_radius, p.y * sine_over_radius, 1 - versine});
  }

 private:
  // 1 - cos of the deflection below which a part s of the light is scattered. The inverse of the distribution, with the
  // division by g cancelled, so that it holds for g = 0 and near it.
  float deflection_versine(float s) const {
    const float remaining = 1 - s;
    const float root = 1 + g_ * (1 - 2 * s);
    return 2 * s * sqr(1 - g_) * (1 + g_ * remaining) / (root * root);
  }

  float g_;
};

}  // namespace fluxfarm
