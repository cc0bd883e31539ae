#include "integrators/irradiance/irradiance_cache.h"

namespace fluxfarm {
namespace {

// Error of an interpolation over the mean of what its records allow for, as measured.
constexpr float kTypicalError = 0.5f;

}  // namespace

IrradianceCache::IrradianceCache(std::vector<IrradianceRecord> records, float max_angle)
    : per_angle_squared_(1 / (max_angle * max_angle)) {
  std::vector<Bounds> bounds;
  bounds.reserve(records.size());
  for (const IrradianceRecord& record : records) bounds.push_back(record.bounds());
  tree_ = BoundsTree(bounds);
  records_.reserve(records.size());
  for (const std::uint32_t index : tree_.order()) records_.push_back(records[index]);
  tree_.forget_order();
}

std::optional<IrradianceCache::Interpolated> IrradianceCache::interpolate(const ReceivingPlace& place,
                                                                          std::uint32_t replicate) const {
  float weight = 0, error = 0;
  Rgb sum, noisy;
  tree_.for_each_near(place.position, [&](std::uint32_t index) {
    const IrradianceRecord& record = records_[index];
    if (record.room() != place.room) return true;
    const IrradianceRecord::Use use = record.use_at(place.position, place.normal, per_angle_squared_);
    if (use.weight > 0) {
      weight += use.weight;
      error += use.weight * use.error;
      sum += use.irradiance * use.weight;
      noisy += use.irradiance * record.replicate_share(replicate) * use.weight;
    }
    return true;
  });
  if (!(weight >= kLeastWeight)) return std::nullopt;
  const float brightness = luminance(sum);
  return Interpolated{noisy / weight, brightness > 0 ? sum * (kTypicalError * error / (weight * brightness)) : Rgb{}};
}

bool IrradianceCache::covers(const ReceivingPlace& place) const {
  float weight = 0;
  tree_.for_each_near(place.position, [&](std::uint32_t index) {
    const IrradianceRecord& record = records_[index];
    if (record.room() == place.room) weight += record.use_at(place.position, place.normal, per_angle_squared_).weight;
    return weight < kLeastWeight;
  });
  return weight >= kLeastWeight;
}

}  // namespace fluxfarm
