#include "integrators/photon/photon_map.h"

#include <algorithm>
#include <limits>

#include "math/bounds.h"
#include "support/parallel.h"

namespace fluxfarm {

class PhotonMap::Builder {
 public:
  Builder(PhotonMap& map, std::span<const Photon> photons, int threads) : map_(map), photons_(photons), items_(photons.size()) {
    parallel_for((items_.size() + kPiece - 1) / kPiece, threads, [&](std::size_t piece, int) {
      for (std::size_t i = piece * kPiece; i < std::min(items_.size(), (piece + 1) * kPiece); ++i) {
        items_[i] = {photons[i].position, static_cast<std::uint32_t>(i)};
      }
    });
    // Level by level until there is work for all threads, then the subtrees each by itself.
    std::vector<Task> tasks{{1, 0, items_.size(), map.leaves()}};
    while (tasks.size() < kSubtrees && tasks.front().node < map.leaves()) {
      std::vector<Task> halves(2 * tasks.size());
      parallel_for(tasks.size(), threads, [&](std::size_t i, int) {
        if (tasks[i].leaves > 1) {
          std::tie(halves[2 * i], halves[2 * i + 1]) = split(tasks[i]);
        } else {
          fill(tasks[i]);
        }
      });
      std::erase_if(halves, [](const Task& task) { return task.leaves == 0; });
      tasks = std::move(halves);
    }
    parallel_for(tasks.size(), threads, [&](std::size_t i, int) { build(tasks[i]); });
  }

 private:
  static constexpr std::size_t kPiece = 1 << 16, kSubtrees = 64;

  struct Item {
    Vec3f position;
    std::uint32_t photon;
  };
  // The node for items_[begin, end), with so many leaves below it.
  struct Task {
    std::uint32_t node = 0;
    std::size_t begin = 0, end = 0, leaves = 0;
  };

  void build(const Task& task) {
    if (task.leaves == 1) return fill(task);
    const auto [left, right] = split(task);
    build(left);
    build(right);
  }

  std::pair<Task, Task> split(const Task& task) {
    Bounds bounds;
    for (std::size_t i = task.begin; i < task.end; ++i) bounds.extend(items_[i].position);
    const Vec3f size = bounds.upper - bounds.lower;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    // Of a complete tree: its lowest row is filled from the left.
    const std::size_t row = std::bit_floor(task.leaves), half = row / 2;
    const std::size_t left_leaves = half + std::min(task.leaves - row, half);
    const std::size_t middle = task.begin + left_leaves * kBlock;
    const auto at = [&](std::size_t i) { return items_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(task.begin), at(middle), at(task.end),
                     [axis](const Item& a, const Item& b) { return a.position[axis] < b.position[axis]; });
    map_.nodes_[task.node] = {items_[middle].position[axis], static_cast<std::uint32_t>(axis)};
    return {{2 * task.node, task.begin, middle, left_leaves}, {2 * task.node + 1, middle, task.end, task.leaves - left_leaves}};
  }

  void fill(const Task& task) {
    const std::size_t block = task.node - map_.leaves();
    Places& places = map_.places_[block];
    places.x.fill(std::numeric_limits<float>::infinity());
    places.y = places.z = places.x;
    for (std::size_t lane = 0; lane < task.end - task.begin; ++lane) {
      const Item& item = items_[task.begin + lane];
      places.x[lane] = item.position.x;
      places.y[lane] = item.position.y;
      places.z[lane] = item.position.z;
      map_.lights_[block * kBlock + lane] = photons_[item.photon].light;
    }
  }

  PhotonMap& map_;
  std::span<const Photon> photons_;
  std::vector<Item> items_;
};

PhotonMap::PhotonMap(std::span<const Photon> photons, int threads) : size_(photons.size()) {
  if (photons.empty()) return;
  for (const Photon& photon : photons) bounds_.extend(photon.position);
  const std::size_t leaves = (photons.size() + kBlock - 1) / kBlock;
  places_.resize(leaves);
  lights_.resize(leaves * kBlock);
  nodes_.resize(leaves);
  Builder(*this, photons, threads);
}

}  // namespace fluxfarm
