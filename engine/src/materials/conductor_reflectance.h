// Fresnel reflectance of a described metal, in RGB, times its specular_reflectance factor.
#pragma once

#include "materials/fresnel.h"
#include "materials/material_description.h"

namespace fluxfarm {

class ConductorReflectance {
 public:
  explicit ConductorReflectance(const ConductorDescription& d)
      : perfect_(d.perfect), factor_(d.specular_reflectance), r_(d.eta.r, d.k.r), g_(d.eta.g, d.k.g), b_(d.eta.b, d.k.b) {}

  // cos_i in [0,1] between the direction and the (microfacet) normal.
  Rgb operator()(float cos_i) const {
    if (perfect_) return factor_;
    return factor_ * Rgb{r_.reflectance(cos_i), g_.reflectance(cos_i), b_.reflectance(cos_i)};
  }

 private:
  bool perfect_;
  Rgb factor_;
  ConductorFresnel r_, g_, b_;
};

}  // namespace fluxfarm
