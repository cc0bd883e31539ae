// Plain description of a participating medium: what the scene file says. No behaviour.
#pragma once

#include "math/rgb.h"

namespace fluxfarm {

inline constexpr int kNoMedium = -1;

// The same everywhere in its region.
struct HomogeneousMediumDescription {
  Rgb sigma_t{1.0f};    // extinction, m^-1; not negative
  Rgb albedo{0.75f};    // sigma_s over sigma_t, in [0,1]
  float asymmetry = 0;  // g of the phase function, mean cosine of the deflection, in (-1,1); 0 scatters evenly
};

}  // namespace fluxfarm
