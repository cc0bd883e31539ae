// Beckmann distribution of microfacet normals (Gaussian slopes) with Smith masking, possibly anisotropic. Members as in ggx.h.
//
// [Walter07] B. Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007: the fit of G1.
// [Heitz14]  E. Heitz and E. d'Eon, "Importance Sampling Microfacet-Based BSDFs using the Distribution of Visible Normals", EGSR
// 2014. [Jakob14]  W. Jakob, "An Improved Visible Normal Sampling Routine for the Beckmann Distribution", 2014: inversion in the
// domain of erf.
//
// The BSDF's value uses the rational fit of G1, as Mitsuba does (within 0.35 % of the exact G1); the density of the sampled normals
// is normalised by the exact G1, so that pdf and samples agree and the estimate of the fitted BSDF is unbiased.
#pragma once

#include "materials/erf_inverse.h"
#include "materials/ggx.h"
#include "math/vec.h"

namespace fluxfarm {

class Beckmann {
 public:
  Beckmann(float alpha_u, float alpha_v)
      : alpha_u_(std::max(alpha_u, kMinAlpha)),
        alpha_v_(std::max(alpha_v, kMinAlpha)),
        inv_alpha_u_(1 / alpha_u_),
        inv_alpha_v_(1 / alpha_v_),
        scale_(kInvPi * inv_alpha_u_ * inv_alpha_v_) {}

  // D(m), per steradian and unit of macroscopic area; m.z >= 0. Zero where it is too small to matter.
  float normal_density(Vec3f m) const {
    const float cos2 = m.z * m.z;
    const float slope2 = sqr(m.x * inv_alpha_u_) + sqr(m.y * inv_alpha_v_);
    if (!(slope2 < 60 * cos2)) return 0;
    return scale_ * std::exp(-slope2 / cos2) / (cos2 * cos2);
  }

  // G1(v) / |cos v|, on the side where v sees the front of the microfacets: the fit of [Walter07].
  float masking_by_cosine(Vec3f v) const {
    const float z = std::abs(v.z), s = stretched_sine(v);
    if (z >= 1.6f * s) return 1 / z;
    const float a = z / s;
    return (3.535f + 2.181f * a) / (s * (1 + a * (2.276f + 2.577f * a)));
  }
  // The same with the exact G1 = 2 / (1 + erf(a) + exp(-a^2) / (a sqrt(pi))).
  float visible_by_cosine(Vec3f v) const {
    const float z = std::abs(v.z), s = stretched_sine(v);
    return 2 / seen_area(z, s);
  }

  // A normal in proportion to D_v(m) = D(m) |wo.m| visible_by_cosine(wo), for wo.z > 0.
  Vec3f sample_normal(Vec3f wo, Vec2f u) const {
    const Vec3f w = normalize({alpha_u_ * wo.x, alpha_v_ * wo.y, wo.z});
    const float sin = safe_sqrt(w.x * w.x + w.y * w.y);
    const float along = sample_slope(w.z, sin, u.x);
    const float across = erf_inverse(std::clamp(2 * u.y - 1, -kErfEnd, kErfEnd));
    const float cos_phi = sin > 0 ? w.x / sin : 1, sin_phi = sin > 0 ? w.y / sin : 0;
    return normalize({-alpha_u_ * (cos_phi * along - sin_phi * across), -alpha_v_ * (sin_phi * along + cos_phi * across), 1});
  }

 private:
  // Slopes are inverted from x = erf(slope) in [-kErfEnd, kErfEnd]: the largest magnitude is 3.6.
  static constexpr float kErfEnd = 1 - 4e-7f;

  float stretched_sine(Vec3f v) const { return std::sqrt(sqr(alpha_u_ * v.x) + sqr(alpha_v_ * v.y)); }

  // z (1 + erf(a)) + s exp(-a^2) / sqrt(pi) with a = z / s: twice the area that microfacets of unit roughness show to (s, z).
  // Beyond a = 2.6 it is 2 z to 8e-6; below, a erf(a) + exp(-a^2) / sqrt(pi) is a polynomial good to 8e-7 (own least-squares fit).
  static float seen_area(float z, float s) {
    if (z >= kFitEnd * s) return 2 * z;
    const float a = z / s;
    float p = kFit[9];
    for (int i = 8; i >= 0; --i) p = kFit[i] + p * a;
    return z + s * p;
  }

  // The slope towards wo of a visible normal for unit roughness: inverts g(s) = cos (1 + erf(s)) + sin exp(-s^2) / sqrt(pi), which
  // grows from 0 to seen_area at s = cos / sin. One Halley step from a start that is within 1e-2 leaves less than 1e-5 of the CDF.
  static float sample_slope(float cos, float sin, float u) {
    constexpr float kInvSqrtPi = 0.564189584f;
    const float end = std::min(erf_estimate(cos, sin), kErfEnd);
    const float x = std::clamp(end - (1 + end) * start_of_inversion(sin, 1 - u), -kErfEnd, end);
    const float slope = erf_inverse(x), gauss = std::exp(-slope * slope);
    const float error = cos * (1 + x) + sin * kInvSqrtPi * gauss - u * seen_area(cos, sin);
    // Derivatives of g: 2 gauss facing / sqrt(pi) and 2 gauss bend / sqrt(pi).
    const float facing = cos - slope * sin, bend = -2 * slope * facing - sin;
    const float denominator = 4 * kInvSqrtPi * gauss * facing * facing - error * bend;
    if (!(denominator > 1e-20f)) return slope;
    return std::clamp(slope - 2 * error * facing / denominator, -4.0f, 4.0f);
  }

  // (erf(end) - x) / (1 + erf(end)) for the wanted x, as a function of y = 1 - u: it is y at normal incidence; own least-squares
  // fit of what is added towards grazing incidence.
  static float start_of_inversion(float sin, float y) {
    const float q = std::sqrt(y);
    const float c0 = -0.66361121f + q * (3.071971f + q * (-1.3079916f + q * 1.2384929f));
    const float c1 = 4.1627635f + q * (-4.1631849f - q * 0.38345147f);
    const float c2 = -3.3069024f + q * 1.984736f;
    const float added = sin * (q - y) * (c0 + sin * (c1 + sin * (c2 + sin * 0.81333654f)));
    return y + std::max(added, 0.0f);
  }

  // erf(z / s) to 1e-4, the derivative of the fit: only for the start of the iteration.
  static float erf_estimate(float z, float s) {
    if (z >= kFitEnd * s) return 1;
    const float a = z / s;
    float p = 9 * kFit[9];
    for (int i = 8; i >= 1; --i) p = static_cast<float>(i) * kFit[i] + p * a;
    return p;
  }

  static constexpr float kFitEnd = 2.6f;
  static constexpr float kFit[10] = {0.564189754f,   -2.83290019e-05f, 0.564786359f,   -0.00438846206f, -0.0785387231f,
                                     -0.0302712888f, 0.0535619906f,    -0.0232747458f, 0.00456942415f,  -0.000352468434f};

  float alpha_u_, alpha_v_, inv_alpha_u_, inv_alpha_v_, scale_;
};

}  // namespace fluxfarm
