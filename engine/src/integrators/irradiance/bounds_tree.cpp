#include "integrators/irradiance/bounds_tree.h"

#include <algorithm>
#include <numeric>

namespace fluxfarm {

BoundsTree::BoundsTree(std::span<const Bounds> bounds) : order_(bounds.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  if (bounds.empty()) return;
  Bounds all;
  for (const Bounds& b : bounds) {
    all.extend(b.lower);
    all.extend(b.upper);
  }
  const Vec3f size = all.upper - all.lower;
  origin_ = all.lower;
  // What has hardly any size is all on the first step.
  constexpr float kLeastExtent = 1e-30f;  // m: steps per metre are a float32
  const auto per_metre = [](float extent) { return extent > kLeastExtent ? kLastStep / extent : 0.0f; };
  steps_per_metre_ = {per_metre(size.x), per_metre(size.y), per_metre(size.z)};
  build(0, order_.size(), bounds);
}

void BoundsTree::build(std::size_t begin, std::size_t end, std::span<const Bounds> bounds) {
  Bounds all, centers;
  for (std::size_t i = begin; i < end; ++i) {
    all.extend(bounds[order_[i]].lower);
    all.extend(bounds[order_[i]].upper);
    centers.extend(bounds[order_[i]].center());
  }
  // Rounding down is monotonic: who lies within a box lies within its steps.
  const std::size_t node = nodes_.size();
  nodes_.push_back({step(all.lower), step(all.upper), 0, 0});
  if (end - begin <= kLeaf) {
    nodes_[node].begin = static_cast<std::uint32_t>(begin);
    nodes_[node].count = static_cast<std::uint32_t>(end - begin);
    return;
  }
  const Vec3f size = centers.upper - centers.lower;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::sort(order_.begin() + static_cast<std::ptrdiff_t>(begin), order_.begin() + static_cast<std::ptrdiff_t>(end),
            [&](std::uint32_t a, std::uint32_t b) {
              const float x = bounds[a].center()[axis], y = bounds[b].center()[axis];
              return x != y ? x < y : a < b;
            });
  const std::size_t middle = begin + (end - begin) / 2;
  build(begin, middle, bounds);
  nodes_[node].begin = static_cast<std::uint32_t>(nodes_.size());
  build(middle, end, bounds);
}

std::array<std::uint16_t, 3> BoundsTree::step(Vec3f place) const {
  const auto along = [](float x) { return static_cast<std::uint16_t>(std::clamp(x, 0.0f, kLastStep)); };
  const Vec3f d = place - origin_;
  return {along(d.x * steps_per_metre_.x), along(d.y * steps_per_metre_.y), along(d.z * steps_per_metre_.z)};
}

}  // namespace fluxfarm
