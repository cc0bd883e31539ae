// Many emitters: a tree over them that picks one in proportion to what it may bring to the place that asks, by going down from the
// root and weighing the children of each node.
//
// [Conty18] A. Conty Estevez, C. Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", PACMCGIT 1(2), 2018.
// What differs from the paper: one emitter is picked a time; a node has up to 16 children in place of two, so that coarse groups
// are never weighed against each other (in place of the paper's splitting); groups are balls; a surface that no light crosses does
// not look behind itself.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "emitters/emitter_bounds.h"
#include "support/vector_clones.h"

namespace fluxfarm {

// Who asks for light: a point, and which directions it can scatter.
struct EmitterReference {
  Vec3f position;           // world, m
  Vec3f normal;             // unit, on the side that takes light; zero: from all around, as in a medium
  bool both_sides = false;  // light from behind the normal counts, too
};

class EmitterTree {
 public:
  EmitterTree() = default;
  // None of the boxes is empty. The same list gives the same tree.
  explicit EmitterTree(const std::vector<EmitterBounds>& emitters);

  struct Choice {
    std::size_t index;  // in the constructor's list
    float probability;
  };
  // The same number u in [0,1) decides at each level and is stretched to [0,1) again for the next: u close to u' gives neighbours
  // in the tree, which keeps the strata of the random numbers. Of its 24 bits every level takes what its decision is worth, so that
  // an emitter whose probability is below 2^-24 may be missed, as with any table of probabilities. Empty: no emitter can bring
  // light to `reference`.
  std::optional<Choice> sample(const EmitterReference& reference, float u) const;
  // Of sample() giving that index from there, to rounding; zero only where the emitter cannot bring light.
  float probability(const EmitterReference& reference, std::size_t index) const;

  bool empty() const { return blocks_.empty(); }
  std::size_t size() const { return leaves_.size(); }

 private:
  static constexpr std::size_t kWidth = 16;
  static constexpr std::size_t kVector = 8;  // lanes that are weighed at once
  static constexpr std::uint32_t kLeaf = 0x80000000u;

  // The children of a node, one in each lane; lanes without a child have no intensity.
  struct alignas(64) Block {
    std::array<float, kWidth> center_x{}, center_y{}, center_z{};  // of the ball, m
    std::array<float, kWidth> radius_squared;                      // m^2
    std::array<float, kWidth> axis_x{}, axis_y{}, axis_z{};
    std::array<float, kWidth> cos_spread{}, sin_spread{}, cos_reach{};
    std::array<float, kWidth> intensity{};
    std::array<std::uint32_t, kWidth> child{};  // block; or kLeaf and the index of the emitter
    std::size_t end = 0;                        // of the lanes with a child, rounded up to a whole kVector

    Block() { radius_squared.fill(1); }
    void set(std::size_t lane, const EmitterBounds& bounds);
  };
  struct Place {
    std::uint32_t block = 0, lane = 0;
  };
  class Builder;

  struct Importances {
    std::array<float, kWidth> of{};  // in units of their own; zero only for what can bring nothing
    float sum;
  };
  FLUXFARM_VECTOR_CLONES static Importances importances(const Block& block, const EmitterReference& reference);

  std::vector<Block> blocks_;   // the root first
  std::vector<Place> parents_;  // of each block
  std::vector<Place> leaves_;   // of each emitter
};

}  // namespace fluxfarm
