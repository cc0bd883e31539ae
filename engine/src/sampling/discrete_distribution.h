// Choice of an index in proportion to weights, by inversion of the cumulative sum.
#pragma once

#include <cstddef>
#include <vector>

namespace fluxfarm {

class DiscreteDistribution {
 public:
  struct Choice {
    std::size_t index;
    float probability;
    float u;  // what is left of the random number, again uniform in [0, 1)
  };

  DiscreteDistribution() = default;
  // Weights are finite and not negative. If all are zero, every index is equally likely.
  explicit DiscreteDistribution(const std::vector<double>& weights);

  // The distribution must not be empty.
  Choice sample(float u) const;
  float probability(std::size_t index) const { return static_cast<float>(upper_[index] - lower(index)); }
  std::size_t size() const { return upper_.size(); }

 private:
  double lower(std::size_t index) const { return index == 0 ? 0.0 : upper_[index - 1]; }

  std::vector<double> upper_;  // cumulative probability up to and with each index; the last is 1
};

}  // namespace fluxfarm
