// What smooth and rough plastic share: the diffuse base under the coat, and the choice between coat and base.
#pragma once

#include "materials/material_description.h"
#include "math/vec.h"

namespace fluxfarm {

// BSDF value of the base, sr^-1, to be multiplied by the coat's transmittance for both directions. `internal_reflectance` is the
// coat's for diffuse light from inside.
inline Rgb plastic_base(const PlasticDescription& d, float internal_reflectance) {
  const Rgb rho = d.diffuse_reflectance;
  const Rgb bounces = d.nonlinear ? rho * internal_reflectance : Rgb{internal_reflectance};
  return rho / (Rgb{1} - bounces) * (kInvPi / (d.eta * d.eta));
}

// Probability of the specular lobe: in proportion to the coat's reflectance and to the factor of each lobe.
class PlasticLobes {
 public:
  explicit PlasticLobes(const PlasticDescription& d)
      : specular_(mean(d.specular_reflectance)), diffuse_(mean(d.diffuse_reflectance)) {
    if (specular_ + diffuse_ <= 0) specular_ = diffuse_ = 1;
  }

  // `reflectance` of the coat for wo, in [0,1].
  float specular(float reflectance) const {
    const float s = reflectance * specular_, d = (1 - reflectance) * diffuse_;
    return s + d > 0 ? s / (s + d) : 0.0f;
  }

 private:
  float specular_, diffuse_;
};

}  // namespace fluxfarm
