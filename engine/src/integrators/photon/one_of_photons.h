// One photon of an estimate, chosen in proportion to what it brings, as they turn up.
//
// [Chao82] M. T. Chao, "A General Purpose Unequal Probability Sampling Plan", Biometrika 69(3), 1982.
#pragma once

#include <cstdint>

#include "integrators/photon/scattered_photons.h"

namespace fluxfarm {

class OneOfPhotons {
 public:
  // `u`: even in [0,1). One number does for all choices: the part of it that a choice leaves open is even again.
  explicit OneOfPhotons(float u) : u_(u) {}

  void offer(std::uint32_t photon, const ScatteredPhotons::Part& part) {
    const float brings = part.wide.r + part.wide.g + part.wide.b;
    if (!(brings > 0)) return;
    sum_ += brings;
    const float probability = brings / sum_;
    if (u_ < probability) {
      u_ /= probability;
      photon_ = photon;
      part_ = part;
      brings_ = brings;
    } else {
      u_ = (u_ - probability) / (1 - probability);
    }
  }

  bool empty() const { return !(sum_ > 0); }  // nothing brings anything
  std::uint32_t photon() const { return photon_; }
  // For all photons that are like it in what one asks of them.
  ScatteredPhotons::Part stands_for() const {
    const float times = sum_ / brings_;
    return {part_.wide * times, part_.narrow * times, part_.smooth};
  }

 private:
  float u_, sum_ = 0, brings_ = 0;
  std::uint32_t photon_ = 0;
  ScatteredPhotons::Part part_;
};

}  // namespace fluxfarm
