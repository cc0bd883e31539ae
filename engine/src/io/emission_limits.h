// How bright and how dim emitters may be, so that squares and sums of their light fit into single precision: with more, radiance
// becomes infinite; with less, photons are so weak that they are lost.
#pragma once

#include "math/rgb.h"

namespace fluxfarm {

inline constexpr float kBrightest = 1e30f, kDimmest = 1e-20f;  // of the largest channel, in the emitter's own unit
inline constexpr const char* kEmissionExpected = "expected 0 or from 1e-20 to 1e30 in the largest channel";

inline bool is_within_emission_limits(Rgb emitted) {
  const float value = max_component(emitted);
  return is_finite(emitted) && (value == 0 || (value >= kDimmest && value <= kBrightest));
}

}  // namespace fluxfarm
