// The nearest of many photons that turn up in any order.
//
// Distances on surfaces lie evenly in their squares, more or less: the k-th least is found by interpolation, in a few passes of
// counting, each a vector loop without a branch. A heap or a quick select guesses a branch for each photon and is often wrong.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace fluxfarm {

class NearestPhotons {
 public:
  // Forgets everything; `count` (at least 1) are wanted, nearer than the square root of `bound` (m^2).
  void start(std::size_t count, float bound);
  // No photon whose squared distance is larger will be among the nearest.
  float bound() const { return bound_; }
  // At most kMaxAdded times, with a squared distance that is not above bound(); then make_room().
  void add(float distance_squared, std::uint32_t photon) {
    distances_[size_] = distance_squared;
    photons_[size_++] = photon;
  }
  static constexpr std::size_t kMaxAdded = 16;
  void make_room() {
    if (size_ > room_) drop_far();
  }
  // Leaves the wanted ones, or all that turned up if those are fewer.
  void finish();

  std::size_t size() const { return size_; }
  std::span<const float> distances_squared() const { return {distances_.data(), size_}; }
  std::span<const std::uint32_t> photons() const { return {photons_.data(), size_}; }
  // The farthest one.
  std::size_t farthest() const;
  void remove(std::size_t index);

 private:
  // A squared distance within which there are at least count_ photons and at most so many more; less only if several are equally
  // far.
  float enough(std::size_t more) const;
  std::size_t count_within(float distance_squared) const;
  void keep_within(float distance_squared);
  void drop_far();

  std::size_t count_ = 1, room_ = 0, size_ = 0;
  float bound_ = std::numeric_limits<float>::max();
  std::vector<float> distances_;  // squared, m^2
  std::vector<std::uint32_t> photons_;
};

}  // namespace fluxfarm
