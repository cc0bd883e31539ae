// Caches of about so many records by each method, and how wrong they are.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "plain_record.h"

namespace fluxfarm::ablation {

// Over the mean irradiance of all places.
struct CacheError {
  double rms = 0;        // with what noise of the records is in it, and without that of the reference
  double noise = 0;      // of the records' irradiance, that part
  double rms_of_99 = 0;  // without the hundredth of the places where it is largest
  double largest = 0;    // with the noise of the reference
};

// The root of the mean of squares, member by member; the largest of the largest.
CacheError together(const std::vector<CacheError>& errors);

struct CacheOfSize {
  double records = 0;  // in the mean
  Limits limits;
  CacheError error;
  double covered = 1;  // part of the places
};

// What is found at a place by all strata and by halves; empty: no record is near, and paths find the truth there.
using Found = std::vector<std::optional<PlainRecord::Told>>;
using Halves = std::vector<std::array<float, 2>>;
CacheError error_of(const Found& found, const Halves& reference);

class AblationCaches {
 public:
  using Order = std::vector<std::size_t>;

  // References have to outlive this. `orders`: of the places by which records are put in, a cache each.
  AblationCaches(const std::vector<KnownPlace>& places, const Halves& reference, std::vector<Order> orders, float scene_radius)
      : places_(places), reference_(reference), orders_(std::move(orders)), scene_radius_(scene_radius) {}

  // With the tolerance that leads to so many records in the first order. Empty: even the largest tolerance leads to more.
  std::optional<CacheOfSize> of_size(const Method& method, float max_spacing_pixels, std::size_t records) const;

 private:
  // In that order each place that no record covers gets one. Stops beyond `most` records.
  std::vector<PlainRecord> build(const Method& method, const Limits& limits, const Order& order, std::size_t most) const;
  Found interpolate(const std::vector<PlainRecord>& records) const;

  const std::vector<KnownPlace>& places_;
  const Halves& reference_;
  std::vector<Order> orders_;
  float scene_radius_;
};

// The tolerance, within [1e-6, 1e3], at which count(tolerance) is `wanted` within 1 % or as near as 20 halvings come; counts fall
// with it. Empty: even the largest leads to more than 1.05 times that.
template <typename Count>
std::optional<float> tolerance_for(std::size_t wanted, const Count& count) {
  float low = 1e-6f, high = 1e3f;
  if (static_cast<double>(count(high)) > 1.05 * static_cast<double>(wanted)) return std::nullopt;
  for (int i = 0; i < 20; ++i) {
    const float middle = std::sqrt(low * high);
    const auto found = static_cast<double>(count(middle)), goal = static_cast<double>(wanted);
    if (std::fabs(found - goal) <= 0.01 * goal) return middle;
    (found > goal ? low : high) = middle;
  }
  return high;
}

}  // namespace fluxfarm::ablation
