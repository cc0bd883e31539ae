// Fresnel's equations for unpolarised light at a smooth interface, and the mean over the hemisphere for a diffuse base under it.
//
// [Born99]  M. Born and E. Wolf, "Principles of Optics", 7th edition, 1999, sections 1.5 and 14.2.
// [Egan73]  W. Egan and T. Hilgeman, 1973: fit of the internal diffuse reflectance, known to us through Mitsuba only.
// [dEon11]  E. d'Eon and G. Irving, "A Quantized-Diffusion Model for Rendering Translucent Materials", SIGGRAPH 2011: another fit.
#pragma once

#include <cmath>

#include "math/rgb.h"
#include "math/vec.h"

namespace fluxfarm {

struct DielectricFresnel {
  float reflectance;  // [0,1]; 1 in total internal reflection
  float cos_t;        // of the refracted direction, on the other side: opposite in sign to cos_i; 0 in total reflection
  float eta;          // index on the refracted side over the index on the side of cos_i
};

// Interface between two dielectrics. `cos_i` is signed: positive on the exterior side. `eta` is interior over exterior index.
inline DielectricFresnel fresnel_dielectric(float cos_i, float eta) {
  const float relative = cos_i >= 0 ? eta : 1 / eta;
  const float inverse = cos_i >= 0 ? 1 / eta : eta;
  if (eta == 1) return {0, -cos_i, 1};
  const float c = std::min(std::abs(cos_i), 1.0f);
  const float cos2_t = 1 - inverse * inverse * (1 - c * c);  // Snell
  if (cos2_t <= 0 || c == 0) return {1, 0, relative};
  const float t = std::sqrt(cos2_t);
  const float s_wave = (c - relative * t) / (c + relative * t);
  const float p_wave = (relative * c - t) / (relative * c + t);
  return {0.5f * (s_wave * s_wave + p_wave * p_wave), cos_i >= 0 ? -t : t, relative};
}

// Interface to a conductor with complex index eta - i k relative to the exterior, one wavelength band. cos_i in [0,1].
// [Born99, section 14.2], with a^2 + b^2 the modulus of the squared complex cosine.
class ConductorFresnel {
 public:
  ConductorFresnel(float eta, float k) : difference_(eta * eta - k * k), product_(4 * eta * eta * k * k) {}

  float reflectance(float cos_i) const {
    const float cos2 = cos_i * cos_i, sin2 = std::max(1 - cos2, 0.0f);
    const float q = difference_ - sin2;
    const float modulus = std::sqrt(q * q + product_);
    const float a = std::sqrt(std::max(0.5f * (modulus + q), 0.0f));
    const float sum = modulus + cos2, twice = 2 * a * cos_i;
    const float p_sum = modulus * cos2 + sin2 * sin2, p_twice = twice * sin2;
    const float s_wave = sum + twice > 0 ? (sum - twice) / (sum + twice) : 1;
    const float p_wave = p_sum + p_twice > 0 ? s_wave * (p_sum - p_twice) / (p_sum + p_twice) : s_wave;
    return 0.5f * (s_wave + p_wave);
  }

 private:
  float difference_, product_;
};

// Mean reflectance of a smooth interface for diffuse light that arrives from a side with index 1 on one with relative index `eta`.
// Fits as Mitsuba uses them: [Egan73] for eta < 1 (0.6 % up to an index of 2), [dEon11] above (0.1 %).
inline float fresnel_diffuse_reflectance(float eta) {
  const float inverse = 1 / eta;
  if (eta < 1) return 0.0636f * inverse + 0.6681f + eta * (0.7099f - 1.4399f * eta);
  return 0.919317f +
         inverse * (-3.4793f + inverse * (6.75335f + inverse * (-7.80989f + inverse * (4.98554f - 1.36881f * inverse))));
}

}  // namespace fluxfarm
