#include "ablation_cache.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace fluxfarm::ablation {

CacheError error_of(const Found& found, const Halves& reference) {
  double mean = 0, noise = 0;
  std::vector<double> squares(found.size());
  CacheError error;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double first = static_cast<double>(reference[i][0]), second = static_cast<double>(reference[i][1]);
    mean += (first + second) / 2;
    if (!found[i]) continue;
    const double all = static_cast<double>(found[i]->all);
    squares[i] = (all - first) * (all - second);
    error.largest = std::max(error.largest, std::fabs(all - (first + second) / 2));
    const double halves = static_cast<double>(found[i]->by_half[0] - found[i]->by_half[1]);
    noise += halves * halves / 4;
  }
  const auto count = static_cast<double>(found.size());
  mean /= count;
  const auto rms = [mean](auto begin, auto end) {
    return std::sqrt(std::max(std::accumulate(begin, end, 0.0) / static_cast<double>(end - begin), 0.0)) / mean;
  };
  error.rms = rms(squares.begin(), squares.end());
  error.noise = std::sqrt(noise / count) / mean;
  error.largest /= mean;
  const auto most = squares.end() - static_cast<std::ptrdiff_t>(found.size() / 100);
  std::sort(squares.begin(), squares.end());
  error.rms_of_99 = rms(squares.begin(), most);
  return error;
}

CacheError together(const std::vector<CacheError>& errors) {
  CacheError sum;
  for (const CacheError& error : errors) {
    sum.rms += error.rms * error.rms;
    sum.noise += error.noise * error.noise;
    sum.rms_of_99 += error.rms_of_99 * error.rms_of_99;
    sum.largest = std::max(sum.largest, error.largest);
  }
  const auto root = [&](double square) { return std::sqrt(square / static_cast<double>(errors.size())); };
  return {root(sum.rms), root(sum.noise), root(sum.rms_of_99), sum.largest};
}

std::vector<PlainRecord> AblationCaches::build(const Method& method, const Limits& limits, const Order& order,
                                               std::size_t most) const {
  std::vector<PlainRecord> records;
  for (const std::size_t index : order) {
    const KnownPlace& place = places_[index];
    const bool covered =
        std::any_of(records.begin(), records.end(), [&](const PlainRecord& record) { return record.weight(place.place) > 0; });
    if (covered) continue;
    records.emplace_back(place, method, limits, scene_radius_);
    if (records.size() > most) break;
  }
  return records;
}

Found AblationCaches::interpolate(const std::vector<PlainRecord>& records) const {
  Found found(places_.size());
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const GatherPlace& place = places_[i].place;
    float weights = 0;
    PlainRecord::Told sum;
    for (const PlainRecord& record : records) {
      const float weight = record.weight(place);
      if (!(weight > 0)) continue;
      const PlainRecord::Told told = record.told(place);
      weights += weight;
      sum.all += weight * told.all;
      for (std::size_t half = 0; half < 2; ++half) sum.by_half[half] += weight * told.by_half[half];
    }
    if (weights > 0) found[i] = {sum.all / weights, {sum.by_half[0] / weights, sum.by_half[1] / weights}};
  }
  return found;
}

std::optional<CacheOfSize> AblationCaches::of_size(const Method& method, float max_spacing_pixels, std::size_t records) const {
  const std::size_t many = records + records / 2;
  const std::optional<float> tolerance = tolerance_for(records, [&](float t) {
    return build(method, {t, max_spacing_pixels}, orders_[0], many).size();
  });
  if (!tolerance) return std::nullopt;
  CacheOfSize cache{0, {*tolerance, max_spacing_pixels}, {}};
  std::vector<CacheError> errors;
  for (const Order& order : orders_) {
    const std::vector<PlainRecord> built = build(method, cache.limits, order, std::numeric_limits<std::size_t>::max());
    cache.records += static_cast<double>(built.size()) / static_cast<double>(orders_.size());
    errors.push_back(error_of(interpolate(built), reference_));
  }
  cache.error = together(errors);
  return cache;
}

}  // namespace fluxfarm::ablation
