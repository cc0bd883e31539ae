#include "integrators/photon/nearest_photons.h"

#include <algorithm>
#include <bit>

namespace fluxfarm {

void NearestPhotons::start(std::size_t count, float bound) {
  count_ = count;
  room_ = count + count / 2;
  size_ = 0;
  bound_ = std::min(bound, std::numeric_limits<float>::max());
  if (distances_.size() < room_ + kMaxAdded) {
    distances_.resize(room_ + kMaxAdded);
    photons_.resize(room_ + kMaxAdded);
  }
}

std::size_t NearestPhotons::count_within(float distance_squared) const {
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < size_; ++i) count += distances_[i] <= distance_squared;
  return count;
}

float NearestPhotons::enough(std::size_t more) const {
  // At most `low` there are `below` < count_, at most `high` there are `within` >= count_.
  float low = -1, high = *std::max_element(distances_.begin(), distances_.begin() + static_cast<std::ptrdiff_t>(size_));
  std::size_t below = 0, within = size_;
  for (int round = 0; within > count_ + more; ++round) {
    float middle;
    if (round < 8) {
      const float part =
          (static_cast<float>(count_ - below) + 0.5f * static_cast<float>(more)) / static_cast<float>(within - below);
      middle = std::max(low, 0.0f) + (high - std::max(low, 0.0f)) * part;
    } else {
      // Not even at all: halves what the bits of the numbers leave, which comes to an end.
      const std::uint32_t low_bits = low < 0 ? 0 : std::bit_cast<std::uint32_t>(low) + 1;
      const std::uint32_t high_bits = std::bit_cast<std::uint32_t>(high);
      if (low_bits >= high_bits) break;
      middle = std::bit_cast<float>(low_bits + (high_bits - low_bits) / 2);
    }
    const std::size_t count = count_within(middle);
    if (count >= count_) {
      high = middle;
      within = count;
    } else {
      low = middle;
      below = count;
    }
  }
  return high;
}

void NearestPhotons::keep_within(float distance_squared) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < size_; ++i) {
    distances_[kept] = distances_[i];
    photons_[kept] = photons_[i];
    kept += distances_[i] <= distance_squared;
  }
  size_ = kept;
}

void NearestPhotons::drop_far() {
  bound_ = enough(count_ / 8);
  keep_within(bound_);
  if (size_ > room_) finish();  // so many are equally far
}

void NearestPhotons::finish() {
  if (size_ <= count_) return;
  const float last = enough(0);
  keep_within(last);
  // Of several that are equally far those that came first.
  for (std::size_t i = size_; size_ > count_ && i-- > 0;) {
    if (distances_[i] == last) remove(i);
  }
}

std::size_t NearestPhotons::farthest() const {
  const auto end = distances_.begin() + static_cast<std::ptrdiff_t>(size_);
  return static_cast<std::size_t>(std::max_element(distances_.begin(), end) - distances_.begin());
}

void NearestPhotons::remove(std::size_t index) {
  --size_;
  distances_[index] = distances_[size_];
  photons_[index] = photons_[size_];
}

}  // namespace fluxfarm
