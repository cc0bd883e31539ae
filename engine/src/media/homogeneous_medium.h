// A participating medium that is the same everywhere: absorbs, scatters, does not emit.
#pragma once

#include <cmath>
#include <limits>

#include "math/rgb.h"
#include "media/medium_description.h"
#include "media/phase_function.h"

namespace fluxfarm {

class HomogeneousMedium {
 public:
  explicit HomogeneousMedium(const HomogeneousMediumDescription& d)
      : sigma_t_(d.sigma_t), sigma_s_(d.sigma_t * d.albedo), phase_(d.asymmetry) {}

  // Part of the radiance that is left after `distance` m (infinity allowed): Beer's and Lambert's law.
  Rgb transmittance(float distance) const {
    return {left(sigma_t_.r, distance), left(sigma_t_.g, distance), left(sigma_t_.b, distance)};
  }

  // Distance to the next collision in that channel, m, with density sigma_t exp(-sigma_t t); infinite where nothing collides.
  float sample_distance(int channel, float u) const {
    const float sigma = channel == 0 ? sigma_t_.r : channel == 1 ? sigma_t_.g : sigma_t_.b;
    return sigma > 0 ? -std::log1p(-u) / sigma : std::numeric_limits<float>::infinity();
  }

  const Rgb& sigma_t() const { return sigma_t_; }  // extinction, m^-1
  const Rgb& sigma_s() const { return sigma_s_; }  // scattering, m^-1
  // Part of the light that a collision scatters.
  Rgb albedo() const {
    const auto part = [](float scattered, float all) { return all > 0 ? scattered / all : 0.0f; };
    return {part(sigma_s_.r, sigma_t_.r), part(sigma_s_.g, sigma_t_.g), part(sigma_s_.b, sigma_t_.b)};
  }
  const PhaseFunction& phase() const { return phase_; }
  // Whether the channels differ in their extinction.
  bool coloured() const { return sigma_t_.r != sigma_t_.g || sigma_t_.g != sigma_t_.b; }

 private:
  static float left(float sigma, float distance) { return sigma > 0 ? std::exp(-sigma * distance) : 1.0f; }

  Rgb sigma_t_, sigma_s_;
  PhaseFunction phase_;
};

}  // namespace fluxfarm
