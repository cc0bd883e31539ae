#include "integrators/irradiance/irradiance_cache.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace fluxfarm {
namespace {

// Error of an interpolation over the mean of what its records allow for, as measured.
constexpr float kTypicalError = 0.5f;

constexpr std::size_t kLeaf = 8;  // records at most

bool holds(const Bounds& b, Vec3f p) {
  return p.x >= b.lower.x && p.x <= b.upper.x && p.y >= b.lower.y && p.y <= b.upper.y && p.z >= b.lower.z && p.z <= b.upper.z;
}

}  // namespace

IrradianceCache::IrradianceCache(std::vector<IrradianceRecord> records, float max_angle)
    : per_angle_squared_(1 / (max_angle * max_angle)) {
  if (records.empty()) return;
  std::vector<Bounds> bounds;
  bounds.reserve(records.size());
  for (const IrradianceRecord& record : records) bounds.push_back(record.bounds());
  std::vector<std::uint32_t> order(records.size());
  std::iota(order.begin(), order.end(), 0u);
  build(0, order.size(), bounds, order);
  records_.reserve(records.size());
  for (const std::uint32_t index : order) records_.push_back(records[index]);
}

void IrradianceCache::build(std::size_t begin, std::size_t end, const std::vector<Bounds>& bounds,
                            std::vector<std::uint32_t>& order) {
  Bounds all, centers;
  for (std::size_t i = begin; i < end; ++i) {
    all.extend(bounds[order[i]].lower);
    all.extend(bounds[order[i]].upper);
    centers.extend(bounds[order[i]].center());
  }
  const std::size_t node = nodes_.size();
  if (end - begin <= kLeaf) {
    nodes_.push_back({all, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end - begin)});
    return;
  }
  nodes_.push_back({all, 0, 0});
  const Vec3f size = centers.upper - centers.lower;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::sort(order.begin() + static_cast<std::ptrdiff_t>(begin), order.begin() + static_cast<std::ptrdiff_t>(end),
            [&](std::uint32_t a, std::uint32_t b) {
              const float x = bounds[a].center()[axis], y = bounds[b].center()[axis];
              return x != y ? x < y : a < b;
            });
  const std::size_t middle = begin + (end - begin) / 2;
  build(begin, middle, bounds, order);
  nodes_[node].begin = static_cast<std::uint32_t>(nodes_.size());
  build(middle, end, bounds, order);
}

// Stops when visit(record) is false.
template <typename Visit>
void IrradianceCache::for_each_near(Vec3f place, const Visit& visit) const {
  if (nodes_.empty()) return;
  std::array<std::uint32_t, 64> waiting;
  std::size_t waits = 0;
  std::uint32_t index = 0;
  for (;;) {
    const Node& node = nodes_[index];
    if (holds(node.bounds, place)) {
      if (node.count == 0) {
        waiting[waits++] = node.begin;
        ++index;
        continue;
      }
      for (std::uint32_t i = node.begin; i < node.begin + node.count; ++i) {
        if (!visit(records_[i])) return;
      }
    }
    if (waits == 0) return;
    index = waiting[--waits];
  }
}

std::optional<IrradianceCache::Interpolated> IrradianceCache::interpolate(const ReceivingPlace& place,
                                                                          std::uint32_t replicate) const {
  float weight = 0, error = 0;
  Rgb sum, noisy;
  for_each_near(place.position, [&](const IrradianceRecord& record) {
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
  for_each_near(place.position, [&](const IrradianceRecord& record) {
    if (record.room() == place.room) weight += record.use_at(place.position, place.normal, per_angle_squared_).weight;
    return weight < kLeastWeight;
  });
  return weight >= kLeastWeight;
}

}  // namespace fluxfarm
