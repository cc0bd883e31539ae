// Which emitter next-event estimation asks: half evenly, half in proportion to power, so that a weak lamp nearby keeps a chance
// beside a strong one far away.
#pragma once

#include <cstddef>
#include <vector>

#include "emitters/emitter.h"
#include "sampling/discrete_distribution.h"

namespace fluxfarm {

class EmitterChoice {
 public:
  EmitterChoice() = default;
  explicit EmitterChoice(const std::vector<const Emitter*>& emitters);

  bool empty() const { return emitters_.empty(); }
  // With one emitter no random number is needed.
  bool single() const { return emitters_.size() == 1; }

  struct Choice {
    const Emitter* emitter;
    float probability;
  };
  // Must not be empty; u in [0,1).
  Choice sample(float u) const;
  // Probability of choosing the emitter with that index in the constructor's list.
  float probability(std::size_t index) const { return single() ? 1.0f : distribution_.probability(index); }

 private:
  std::vector<const Emitter*> emitters_;
  DiscreteDistribution distribution_;
};

}  // namespace fluxfarm
