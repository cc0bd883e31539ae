#include "integrators/irradiance/bounds_tree.h"

#include <algorithm>
#include <numeric>

namespace fluxfarm {
namespace {

constexpr std::size_t kLeaf = 8;  // boxes at most

}  // namespace

BoundsTree::BoundsTree(std::span<const Bounds> bounds) : order_(bounds.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  if (!bounds.empty()) build(0, order_.size(), bounds);
}

void BoundsTree::build(std::size_t begin, std::size_t end, std::span<const Bounds> bounds) {
  Bounds all, centers;
  for (std::size_t i = begin; i < end; ++i) {
    all.extend(bounds[order_[i]].lower);
    all.extend(bounds[order_[i]].upper);
    centers.extend(bounds[order_[i]].center());
  }
  const std::size_t node = nodes_.size();
  if (end - begin <= kLeaf) {
    nodes_.push_back({all, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end - begin)});
    return;
  }
  nodes_.push_back({all, 0, 0});
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

}  // namespace fluxfarm
