// The measure of the photon map: nanoflann's kd-tree over the same photons, where its header was found.
#pragma once

#ifdef FLUXFARM_NANOFLANN

#include <cstddef>
#include <memory>
#include <nanoflann.hpp>
#include <utility>
#include <vector>

#include "integrators/photon/photon.h"

namespace fluxfarm {

class NanoflannMap {
 public:
  explicit NanoflannMap(const std::vector<Photon>& photons) : cloud_{photons}, tree_(3, cloud_) { tree_.buildIndex(); }

  struct Workspace {
    std::vector<std::size_t> indices;
    std::vector<float> distances;
    std::vector<std::pair<std::size_t, float>> found;
  };

  // Calls visit(photon, squared distance) for the nearest `count` photons, the nearest first.
  template <typename Visit>
  void nearest(Vec3f center, std::size_t count, Workspace& space, Visit&& visit) const {
    space.indices.resize(count);
    space.distances.resize(count);
    const std::size_t found = tree_.knnSearch(&center.x, count, space.indices.data(), space.distances.data());
    for (std::size_t i = 0; i < found; ++i) visit(cloud_.photons[space.indices[i]], space.distances[i]);
  }

  // The same for all within `radius`, in any order.
  template <typename Visit>
  void within(Vec3f center, float radius, Workspace& space, Visit&& visit) const {
    space.found.clear();
    Within set{radius * radius, space.found};
    tree_.findNeighbors(set, &center.x, {});
    for (const auto& [index, distance_squared] : space.found) visit(cloud_.photons[index], distance_squared);
  }

 private:
  // Takes what the tree finds: its own set for a radius has another type from version 1.5 on.
  struct Within {
    using DistanceType = float;
    float bound;  // m^2
    std::vector<std::pair<std::size_t, float>>& found;

    bool addPoint(float distance_squared, std::size_t index) {
      if (distance_squared < bound) found.emplace_back(index, distance_squared);
      return true;
    }
    float worstDist() const { return bound; }
    bool full() const { return true; }
    std::size_t size() const { return found.size(); }
    void sort() const {}  // any order will do
  };
  struct Cloud {
    const std::vector<Photon>& photons;
    std::size_t kdtree_get_point_count() const { return photons.size(); }
    float kdtree_get_pt(std::size_t index, std::size_t axis) const { return photons[index].position[static_cast<int>(axis)]; }
    template <typename Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };

  Cloud cloud_;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3, std::size_t> tree_;
};

}  // namespace fluxfarm

#endif
