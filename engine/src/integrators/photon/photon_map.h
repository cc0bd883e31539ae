// Finds photons near a place: a balanced kd-tree over small blocks of photons.                         [Bentley75, Friedman77]
//
// Every leaf holds kBlock photons (the last one fewer), whose places stand in three short arrays that one vector loop compares with
// the place that asks. The tree is complete, so that nodes need no pointers, and is built by medians along the widest axis: what it
// is depends on the photons and their order alone. Why it, and not a grid: docs/decisions/0006.
//
// [Bentley75]  J. L. Bentley, "Multidimensional Binary Search Trees Used for Associative Searching", CACM 18(9), 1975.
// [Friedman77] J. H. Friedman, J. L. Bentley, R. A. Finkel, "An Algorithm for Finding Best Matches in Logarithmic Expected
//              Time", ACM TOMS 3(3), 1977.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "integrators/photon/beam.h"
#include "integrators/photon/nearest_photons.h"
#include "integrators/photon/photon.h"
#include "math/bounds.h"
#include "math/vec.h"

namespace fluxfarm {

class PhotonMap {
 public:
  PhotonMap() = default;
  // Fewer than 2^32 photons.
  PhotonMap(std::span<const Photon> photons, int threads);

  std::size_t size() const { return size_; }
  std::size_t bytes() const {
    return places_.size() * sizeof(Places) + lights_.size() * sizeof(PhotonLight) + nodes_.size() * sizeof(Node);
  }

  // Calls visit(d, light) for each photon at most `radius` (m) from `center`, in an order that is fixed; d leads from `center` to
  // the photon.
  template <typename Visit>
  void for_each_within(Vec3f center, float radius, Visit&& visit) const;

  // Calls visit(distance, across, light) for each photon in the beam, in an order that is fixed: how far along the beam it is, m,
  // and the square of how far from its axis, over that of the beam's radius there.
  template <typename Visit>
  void for_each_in(const Beam& beam, Visit&& visit) const;

  // Adds to `nearest` each photon that accept(d, light) takes and that may be among those which it wants.
  template <typename Accept>
  void find_nearest(Vec3f center, Accept&& accept, NearestPhotons& nearest) const;

  const PhotonLight& light(std::uint32_t photon) const { return lights_[photon]; }
  Vec3f position(std::uint32_t photon) const { return offset(photon / kBlock, photon % kBlock, {}); }  // world, m

 private:
  static constexpr std::size_t kBlock = 16;

  // Of the photons of one leaf; lanes without a photon are infinitely far away.
  struct alignas(64) Places {
    std::array<float, kBlock> x, y, z;
  };
  struct Node {
    float split;  // m; what is less stands in the left half, what is more in the right one
    std::uint32_t axis;
  };
  // Of the photons of a leaf those within a distance.
  struct Lanes {
    std::array<float, kBlock> distance_squared;
    std::array<std::uint32_t, kBlock> lane;
    std::size_t count = 0;
  };
  // The same of those in a beam.
  struct BeamLanes {
    std::array<float, kBlock> distance, across;
    std::array<std::uint32_t, kBlock> lane;
    std::size_t count = 0;
  };
  class Builder;
  // A node that is still to be visited.
  struct Later {
    std::uint32_t node;
    float distance_squared;  // at least, m^2
  };

  // Calls visit(leaf) for the leaves that may hold photons within the square root of bound(), near ones first.
  template <typename Bound, typename Visit>
  void visit_leaves(Vec3f center, Bound&& bound, Visit&& visit) const;

  // Children of node i are 2 i and 2 i + 1; the root is 1 and from leaves() on they are leaves.
  std::size_t leaves() const { return places_.size(); }
  Lanes lanes_within(std::size_t block, Vec3f center, float radius_squared) const {
    const Places& places = places_[block];
    Lanes lanes;
    for (std::size_t i = 0; i < kBlock; ++i) {
      const float x = places.x[i] - center.x, y = places.y[i] - center.y, z = places.z[i] - center.z;
      lanes.distance_squared[i] = x * x + y * y + z * z;
    }
    // Whether a photon is near enough cannot be guessed: no branch.
    for (std::uint32_t i = 0; i < kBlock; ++i) {
      lanes.lane[lanes.count] = i;
      lanes.count += lanes.distance_squared[i] <= radius_squared;
    }
    return lanes;
  }
  BeamLanes lanes_in(std::size_t block, const Beam& beam) const {
    const Places& places = places_[block];
    const Vec3f o = beam.origin, v = beam.direction;
    BeamLanes lanes;
    for (std::size_t i = 0; i < kBlock; ++i) {
      const float x = places.x[i] - o.x, y = places.y[i] - o.y, z = places.z[i] - o.z;
      const float along = x * v.x + y * v.y + z * v.z;
      const float across_x = x - along * v.x, across_y = y - along * v.y, across_z = z - along * v.z;
      const float squared = across_x * across_x + across_y * across_y + across_z * across_z;
      lanes.distance[i] = along;
      lanes.across[i] = (along >= 0) & (along <= beam.length) ? squared / sqr(beam.radius_at(along)) : 2.0f;
    }
    for (std::uint32_t i = 0; i < kBlock; ++i) {
      lanes.lane[lanes.count] = i;
      lanes.count += lanes.across[i] <= 1;
    }
    return lanes;
  }
  Vec3f offset(std::size_t block, std::uint32_t lane, Vec3f center) const {
    const Places& places = places_[block];
    return Vec3f{places.x[lane], places.y[lane], places.z[lane]} - center;
  }

  std::size_t size_ = 0;
  Bounds bounds_;               // of all photons
  std::vector<Places> places_;  // of each leaf
  std::vector<PhotonLight> lights_;
  std::vector<Node> nodes_;
};

template <typename Bound, typename Visit>
void PhotonMap::visit_leaves(Vec3f center, Bound&& bound, Visit&& visit) const {
  if (size_ == 0) return;
  std::array<Later, 32> later;
  std::size_t waiting = 0;
  later[waiting++] = {1, 0};
  while (waiting > 0) {
    const Later next = later[--waiting];
    if (next.distance_squared > bound()) continue;
    std::uint32_t i = next.node;
    while (i < leaves()) {
      const float beyond = center[static_cast<int>(nodes_[i].axis)] - nodes_[i].split;
      const std::uint32_t near = 2 * i + (beyond > 0);
      later[waiting] = {near ^ 1, std::max(beyond * beyond, next.distance_squared)};
      waiting += beyond * beyond <= bound();
      i = near;
    }
    visit(i - leaves());
  }
}

template <typename Visit>
void PhotonMap::for_each_within(Vec3f center, float radius, Visit&& visit) const {
  const float radius_squared = std::min(radius * radius, std::numeric_limits<float>::max());
  visit_leaves(
      center, [&] { return radius_squared; },
      [&](std::size_t block) {
        const Lanes lanes = lanes_within(block, center, radius_squared);
        for (std::size_t k = 0; k < lanes.count; ++k) {
          visit(offset(block, lanes.lane[k], center), lights_[block * kBlock + lanes.lane[k]]);
        }
      });
}

template <typename Visit>
void PhotonMap::for_each_in(const Beam& beam, Visit&& visit) const {
  if (size_ == 0) return;
  struct Piece {
    std::uint32_t node;
    BeamPart part;
  };
  std::array<Piece, 32> later;
  std::size_t waiting = 0;
  later[waiting++] = {1, beam.part_in(bounds_)};
  while (waiting > 0) {
    auto [node, part] = later[--waiting];
    while (!part.empty() && node < leaves()) {
      const int axis = static_cast<int>(nodes_[node].axis);
      const BeamPart right = beam.above(part, axis, nodes_[node].split);
      later[waiting] = {2 * node + 1, right};
      waiting += !right.empty();
      part = beam.below(part, axis, nodes_[node].split);
      node = 2 * node;
    }
    if (part.empty()) continue;
    const std::size_t block = node - leaves();
    const BeamLanes lanes = lanes_in(block, beam);
    for (std::size_t k = 0; k < lanes.count; ++k) {
      const std::uint32_t lane = lanes.lane[k];
      visit(lanes.distance[lane], lanes.across[lane], lights_[block * kBlock + lane]);
    }
  }
}

template <typename Accept>
void PhotonMap::find_nearest(Vec3f center, Accept&& accept, NearestPhotons& nearest) const {
  static_assert(kBlock <= NearestPhotons::kMaxAdded);
  visit_leaves(
      center, [&] { return nearest.bound(); },
      [&](std::size_t block) {
        const Lanes lanes = lanes_within(block, center, nearest.bound());
        for (std::size_t k = 0; k < lanes.count; ++k) {
          const auto photon = static_cast<std::uint32_t>(block * kBlock + lanes.lane[k]);
          if (!accept(offset(block, lanes.lane[k], center), lights_[photon])) continue;
          nearest.add(lanes.distance_squared[lanes.lane[k]], photon);
        }
        nearest.make_room();
      });
}

}  // namespace fluxfarm
