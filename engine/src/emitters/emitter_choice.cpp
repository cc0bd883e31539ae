#include "emitters/emitter_choice.h"

namespace fluxfarm {

EmitterChoice::EmitterChoice(const std::vector<const Emitter*>& emitters) : emitters_(emitters) {
  if (emitters.size() < 2) return;
  const double count = static_cast<double>(emitters.size());
  double total = 0;
  for (const Emitter* emitter : emitters) total += static_cast<double>(luminance(emitter->power()));
  std::vector<double> weights;
  for (const Emitter* emitter : emitters) {
    const double by_power = total > 0 ? static_cast<double>(luminance(emitter->power())) / total : 1 / count;
    weights.push_back(0.5 / count + 0.5 * by_power);
  }
  distribution_ = DiscreteDistribution(weights);
}

EmitterChoice::Choice EmitterChoice::sample(float u) const {
  if (single()) return {emitters_.front(), 1.0f};
  const DiscreteDistribution::Choice choice = distribution_.sample(u);
  return {emitters_[choice.index], choice.probability};
}

}  // namespace fluxfarm
