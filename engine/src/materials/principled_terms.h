// The formulas of the principled BSDF, a function each: Fresnel blends, diffuse with retro-reflection, flattened diffuse, sheen.
// All cosines are those of unit directions above the surface, in [0,1].
//
// [Burley12] B. Burley, "Physically-Based Shading at Disney", SIGGRAPH 2012 course notes.
// [Burley15] B. Burley, "Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering", SIGGRAPH 2015 course notes.
#pragma once

#include "materials/fresnel.h"

namespace fluxfarm {

// What a principled material says at one place; ranges as in PrincipledDescription.
struct PrincipledParameters {
  Rgb base_color;
  float roughness = 0.5f, anisotropic = 0, metallic = 0, spec_trans = 0, spec_tint = 0;
  float sheen = 0, sheen_tint = 0, flatness = 0, clearcoat = 0, clearcoat_gloss = 0;
  float eta = 1.5f;  // inside over outside
};

// (1 - cos)^5
inline float schlick_weight(float cos) {
  const float x = std::clamp(1 - cos, 0.0f, 1.0f), x2 = x * x;
  return x2 * x2 * x;
}

// Weight of Schlick's approximation at a microfacet seen from outside; into a thinner medium the angle of the refracted light
// counts.
inline float schlick_weight_into(float cos, float eta) {
  return schlick_weight(eta > 1 ? cos : safe_sqrt(1 - (1 - cos * cos) / (eta * eta)));
}

inline Rgb mix(Rgb a, Rgb b, float t) { return a * (1 - t) + b * t; }
inline float mix(float a, float b, float t) { return a * (1 - t) + b * t; }

// The hue of a colour: of luminance one; white for black.
inline Rgb tint_of(Rgb colour) {
  const float y = luminance(colour);
  return y > 0 ? colour / y : Rgb{1.0f};
}

// Reflectance of a microfacet seen from outside: metal, dielectric and tinted dielectric, blended. `dielectric` is Fresnel's.
inline Rgb principled_fresnel(const PrincipledParameters& p, float dielectric, float cos) {
  Rgb f{(1 - p.metallic) * (1 - p.spec_tint) * dielectric};
  if (p.metallic == 0 && p.spec_tint == 0) return f;
  const float weight = schlick_weight_into(cos, p.eta);
  f += p.metallic * mix(p.base_color, Rgb{1.0f}, weight);
  if (p.spec_tint > 0) {
    const Rgb normal = tint_of(p.base_color) * sqr((p.eta - 1) / (p.eta + 1));
    f += (1 - p.metallic) * p.spec_tint * mix(normal, Rgb{1.0f}, weight);
  }
  return f;
}

// Diffuse value over base_color / pi: Fresnel's loss, retro-reflection of rough surfaces [Burley12, section 5.3], blended with the
// shape of subsurface scattering [Burley15]. cos_d: between a direction and the half vector.
inline float principled_diffuse(const PrincipledParameters& p, float cos_o, float cos_i, float cos_d) {
  const float f_o = schlick_weight(cos_o), f_i = schlick_weight(cos_i);
  const float retro = 2 * p.roughness * cos_d * cos_d;
  const float rough = (1 - 0.5f * f_o) * (1 - 0.5f * f_i) + retro * (f_o + f_i + f_o * f_i * (retro - 1));
  if (p.flatness == 0) return rough;
  const float grazing = 0.5f * retro;
  const float seen = mix(1.0f, grazing, f_o) * mix(1.0f, grazing, f_i);
  const float flat = 1.25f * (seen * (1 / (cos_o + cos_i) - 0.5f) + 0.5f);
  return mix(rough, flat, p.flatness);
}

// Value of the sheen of cloth at grazing half angles, sr^-1.
inline Rgb principled_sheen(const PrincipledParameters& p, float cos_d) {
  const Rgb colour = mix(Rgb{1.0f}, tint_of(p.base_color), p.sheen_tint);
  return colour * (p.sheen * (1 - p.metallic) * schlick_weight(cos_d));
}

}  // namespace fluxfarm
