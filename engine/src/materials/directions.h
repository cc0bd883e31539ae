// Small geometry shared by the BSDFs: mirror and refracted directions, half vectors. All vectors are unit and leave the point.
#pragma once

#include <cmath>
#include <optional>

#include "materials/bsdf.h"
#include "math/vec.h"

namespace fluxfarm {

// Mirror direction about the macroscopic normal (z).
inline Vec3f reflect(Vec3f wo) { return {-wo.x, -wo.y, wo.z}; }
// Mirror direction about a microfacet normal `m`; cos_m = dot(wo, m).
inline Vec3f reflect(Vec3f wo, Vec3f m, float cos_m) { return m * (2 * cos_m) - wo; }

// Refracted direction about `m`; cos_t (signed) and eta as fresnel_dielectric returns them for cos_m.
inline Vec3f refract(Vec3f wo, Vec3f m, float cos_m, float cos_t, float eta) {
  const float inverse = 1 / eta;
  return m * (cos_m * inverse + cos_t) - wo * inverse;
}

// The microfacet normal, on the side of +z, that takes wo to wi by reflection (eta = 1) or refraction (eta: index on the side of wi
// over that of wo). Empty if wo and wi cancel or the normal is in the macroscopic plane.
inline std::optional<Vec3f> half_vector(const Vec3f& wo, const Vec3f& wi, float eta) {
  const Vec3f h = wo + wi * eta;
  const float length2 = length_squared(h);
  if (!(length2 > 1e-18f) || h.z == 0) return std::nullopt;
  return h * (std::copysign(1.0f, h.z) / std::sqrt(length2));
}

// All light of that direction, tinted, scattered straight on.
inline BsdfSample straight_on(const Vec3f& wo, Rgb tint) { return {.wi = -wo, .weight = tint, .delta = true}; }
// All light of that direction, on its way as if there were no surface.
inline BsdfSample pass(const Vec3f& wo) { return {.wi = -wo, .weight = Rgb{1.0f}, .delta = true, .passes = true}; }

// A random number that was stretched after a choice, kept in [0,1).
inline float below_one(float u) { return std::min(u, 1 - 0x1p-24f); }

}  // namespace fluxfarm
