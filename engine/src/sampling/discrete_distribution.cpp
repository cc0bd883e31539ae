#include "sampling/discrete_distribution.h"

#include <algorithm>

namespace fluxfarm {

DiscreteDistribution::DiscreteDistribution(const std::vector<double>& weights) : upper_(weights) {
  double total = 0;
  for (const double weight : weights) total += weight;
  double sum = 0;
  for (std::size_t i = 0; i < upper_.size(); ++i) {
    sum += total > 0 ? weights[i] / total : 1.0 / static_cast<double>(upper_.size());
    upper_[i] = sum;
  }
  // Rounding must not leave a gap at the end: everything from the last index with weight on reaches 1.
  if (upper_.empty()) return;
  const double last = upper_.back();
  for (std::size_t i = upper_.size(); i-- > 0 && upper_[i] == last;) upper_[i] = 1;
}

DiscreteDistribution::Choice DiscreteDistribution::sample(float u) const {
  const auto found = std::upper_bound(upper_.begin(), upper_.end(), static_cast<double>(u));
  const auto index = std::min(static_cast<std::size_t>(found - upper_.begin()), upper_.size() - 1);
  const double begin = lower(index);
  const double width = upper_[index] - begin;
  const double rest = (static_cast<double>(u) - begin) / width;
  return {index, static_cast<float>(width), std::min(static_cast<float>(rest), 0x1.fffffep-1f)};
}

}  // namespace fluxfarm
