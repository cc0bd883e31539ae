// Finds boxes that hold a place: a tree of boxes around boxes. Any number of threads may ask.
//
// Small leaves spare more visits to boxes than they cost in nodes, which have 16 bytes each: the sides of their boxes lie on a grid
// of 32,768 steps along each axis, rounded outwards.
#pragma once

#include <array>
#include <bit>
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
  // A place on the grid: 15 bits for each axis, in lanes of 16.
  using Steps = std::uint64_t;
  static constexpr Steps kLanes = 0x7fff'7fff'7fff, kAbove = 0x8000'8000'8000;  // bits of the lanes, and those above them
  static constexpr float kLastStep = 0x7fff;

  // The nodes of a subtree stand together, the node itself first, then its left part.
  struct Node {
    std::array<std::uint16_t, 3> lower, upper;
    std::uint32_t begin : 28;  // of its boxes in order_, if it is a leaf; else where its right part begins in nodes_
    std::uint32_t count : 4;   // of its boxes; 0: not a leaf
  };
  static constexpr std::size_t kLeaf = 3;  // boxes at most

  void build(std::size_t begin, std::size_t end, std::span<const Bounds> bounds);
  // Along each axis, rounded down.
  std::array<std::uint16_t, 3> step(Vec3f place) const;
  // All three axes at once: where a difference is not negative it leaves the bit above its lane.
  static bool holds(const Node& node, Steps p) {
    const auto words = std::bit_cast<std::array<std::uint64_t, 2>>(node);
    const Steps lower = words[0] & kLanes, upper = (words[0] >> 48 | words[1] << 16) & kLanes;
    return (((p | kAbove) - lower) & ((upper | kAbove) - p) & kAbove) == kAbove;
  }

  Vec3f origin_, steps_per_metre_;  // of the grid: world, m
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

template <typename Visit>
void BoundsTree::for_each_near(Vec3f place, const Visit& visit) const {
  if (nodes_.empty()) return;
  const std::array<std::uint16_t, 3> steps = step(place);
  const Steps p = steps[0] | Steps{steps[1]} << 16 | Steps{steps[2]} << 32;
  std::array<std::uint32_t, 64> waiting;
  std::size_t waits = 0;
  std::uint32_t index = 0;
  for (;;) {
    const Node& node = nodes_[index];
    if (holds(node, p)) {
      if (node.count == 0) {
        waiting[waits++] = node.begin;
        ++index;
        continue;
      }
      for (std::uint32_t i = 0; i < node.count; ++i) {
        if (!visit(node.begin + i)) return;
      }
    }
    if (waits == 0) return;
    index = waiting[--waits];
  }
}

}  // namespace fluxfarm
