// Free flight in media whose extinction has a colour: one channel chooses all distances of a path, and the path is weighted as if
// each of the three had been tried.
//
// A path is chosen by channel c with density p_c, the product of its free flights' densities. Its weight is f / mean_c(p_c): the
// balance heuristic for one sample of an evenly chosen technique, so no colour weighs more than three times its due however often
// the path scatters. Weights by a product of such means, one for each flight, would spread without bound.
//
// [Veach97]  E. Veach, "Robust Monte Carlo Methods for Light Transport Simulation", PhD thesis, Stanford 1997.
// [Wilkie14] A. Wilkie et al., "Hero Wavelength Spectral Sampling", EGSR 2014.
#pragma once

#include <algorithm>
#include <cmath>

#include "media/homogeneous_medium.h"

namespace fluxfarm {

class ChannelMis {
 public:
  // The factor on the throughput of having flown `distance` m (finite) and collided: scattering, not absorption.
  Rgb scatter(const HomogeneousMedium& medium, float distance) {
    const Rgb left = relative_transmittance(medium, distance);
    return weighted(medium.sigma_s() * left, medium.sigma_t() * left);
  }

  // The same with absorption left to what follows: the light that collides.
  Rgb collide(const HomogeneousMedium& medium, float distance) {
    const Rgb colliding = medium.sigma_t() * relative_transmittance(medium, distance);
    return weighted(colliding, colliding);
  }

  // The same of having flown `distance` m (infinity allowed) without a collision.
  Rgb pass(const HomogeneousMedium& medium, float distance) {
    const Rgb left = relative_transmittance(medium, distance);
    return weighted(left, left);
  }

 private:
  // f over the mean density of the whole path; `density` and `f` may share a factor.
  Rgb weighted(Rgb f, Rgb density) {
    density_ *= density;
    const float all = mean(density_);
    if (!(all > 0)) return {};  // no channel could have chosen this path
    density_ = density_ / all;
    return f / all;
  }

  // The transmittance over that of the clearest channel, which cancels: thick media do not run out of digits.
  static Rgb relative_transmittance(const HomogeneousMedium& medium, float distance) {
    const Rgb& sigma = medium.sigma_t();
    const float clearest = std::min(sigma.r, std::min(sigma.g, sigma.b));
    const auto left = [&](float own) { return own > clearest ? std::exp((clearest - own) * distance) : 1.0f; };
    return {left(sigma.r), left(sigma.g), left(sigma.b)};
  }

  Rgb density_{1.0f};  // of the path so far, for each channel, over the mean of all three
};

}  // namespace fluxfarm
