// Transmittance and reflectance of a rough dielectric coat for diffuse light, tabulated once per material.
//
// As in Mitsuba's `roughplastic`: 64 equidistant cosines, linear between them; light that the microfacets would scatter twice is
// lost. The internal reflectance is the plain mean of the 64 nodes, which is 1.6 % below the integral for a smooth coat: kept,
// because the colour of the base depends on it and pictures have to agree.
#pragma once

#include <array>

#include "math/vec.h"

namespace fluxfarm {

class CoatTable {
 public:
  template <class Distribution>
  CoatTable(const Distribution& distribution, float eta);

  // Part of the light from direction cos (in [0,1], outside) that gets through the coat.
  float transmittance(float cos) const {
    const float x = std::min(cos, 1.0f) * (kNodes - 1);
    const int i = std::min(static_cast<int>(x), kNodes - 2);
    const float t = x - static_cast<float>(i);
    return transmittance_[static_cast<std::size_t>(i)] * (1 - t) + transmittance_[static_cast<std::size_t>(i) + 1] * t;
  }
  // Part of diffuse light from inside that the coat throws back.
  float internal_reflectance() const { return internal_reflectance_; }
  // Part of diffuse light from outside that gets through.
  float mean_transmittance() const { return mean_transmittance_; }

 private:
  static constexpr int kNodes = 64;
  std::array<float, kNodes> transmittance_;
  float internal_reflectance_ = 0;
  float mean_transmittance_ = 0;
};

}  // namespace fluxfarm
