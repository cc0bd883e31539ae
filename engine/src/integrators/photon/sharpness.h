// Which light photons carry and which the paths from the eye find, so that each is counted once and by whom it suits.
//
// A path from the eye finds light badly that arrives in a narrow beam: it has to hit the beam by chance. So every scattering of
// light is taken for a sharp one with a probability that depends on how narrow it is, from 1 for a mirror to 0 for anything that
// spreads light over a steradian. Photons carry what is scattered sharply once or more often and then, for the first time, not
// sharply, up to that place: caustics. Paths from the eye carry the rest. Both evaluate the same smooth function of the same
// path of light, so their shares add up to one, and as a surface gets rougher or a lamp larger the light goes over from one to the
// other without a step.
//
// How narrow: by the solid angle 1 / f over which a scattering of value f (sr^-1, its largest channel; infinite for a delta lobe)
// would spread, and for the first scattering on the way also by the solid angle that the emitter fills there.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "emitters/emitter.h"
#include "materials/bsdf.h"

namespace fluxfarm {

// The probability that light spread over so many sr is taken for sharp.
inline float sharpness(float solid_angle) {
  constexpr float kWide = 1;  // sr; a sixth of what leaves a diffuse surface goes into one half of it
  const float u = std::min(solid_angle / kWide, 1.0f);
  return (1 - u) * (1 - u) * (1 + 2 * u);
}

// The value of the lobe that was sampled, sr^-1.
inline float lobe_value(const BsdfSample& s) {
  return s.delta ? std::numeric_limits<float>::infinity() : max_component(s.weight) * s.pdf / std::fabs(s.wi.z);
}

// What photons leave to a path that is traced back from the eye.
class PhotonShare {
 public:
  // The path's ray has come so far (m), without being scattered there.
  void travel(float distance) { travelled_ += distance; }
  // Scattered with that value, in sr^-1.
  void scatter(float value) {
    sharp_before_ *= sharpness(1 / value_);
    value_ = value;
    travelled_ = 0;
  }

  // The part of light that stays with the path, by where it found the light: by going on to an emitter that looks so large (its
  // last stretch, too, has to be told to travel()),
  float left_of_found(ApparentSize size) const { return 1 - sharpness(1 / value_ + size.from(travelled_)) * (1 - sharp_before_); }
  // or by asking one that fills `solid_angle` (sr) for light that is scattered with `value` (sr^-1).
  float left_of_asked(float value, float solid_angle) const {
    return 1 - sharpness(1 / value + solid_angle) * (1 - sharp_before_ * sharpness(1 / value_));
  }

 private:
  float value_ = std::numeric_limits<float>::infinity();  // of the last scattering
  float sharp_before_ = 1;                                // that all those before it were sharp
  float travelled_ = 0;                                   // since then, m
};

}  // namespace fluxfarm
