// Finds boxes that hold a place: a tree of boxes around boxes. Any number of threads may ask.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "math/bounds.h"

namespace fluxfarm {

class BoundsTree {
 public:
  BoundsTree() = default;
  explicit BoundsTree(std::span<const Bounds> bounds);

  // Indices of the boxes in the order of the leaves. Who keeps what is in them in this order has what is near together, and may
  // forget it.
  std::span<const std::uint32_t> order() const { return order_; }
  void forget_order() { order_ = {}; }
  std::size_t bytes() const { return nodes_.size() * sizeof(Node); }

  // Calls visit(position in order()) for all boxes that hold the place, and some others, until it returns false.
  template <typename Visit>
  void for_each_near(Vec3f place, const Visit& visit) const;

 private:
  // The nodes of a subtree stand together, the node itself first, then its left part.
  struct Node {
    Bounds bounds;
    std::uint32_t begin;  // of its boxes in order_, if it is a leaf; else where its right part begins in nodes_
    std::uint32_t count;  // of its boxes; 0: not a leaf
  };

  void build(std::size_t begin, std::size_t end, std::span<const Bounds> bounds);
  static bool holds(const Bounds& b, Vec3f p) {
    return p.x >= b.lower.x && p.x <= b.upper.x && p.y >= b.lower.y && p.y <= b.upper.y && p.z >= b.lower.z && p.z <= b.upper.z;
  }

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

template <typename Visit>
void BoundsTree::for_each_near(Vec3f place, const Visit& visit) const {
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
        if (!visit(i)) return;
      }
    }
    if (waits == 0) return;
    index = waiting[--waits];
  }
}

}  // namespace fluxfarm
