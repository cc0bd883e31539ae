// Building the tree from the top: each group is cut across one axis where the two halves promise to be the tightest.
#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "emitters/emitter_tree.h"

namespace fluxfarm {
namespace {

constexpr int kBuckets = 12;
// m^2; keeps the importance of a point finite.
constexpr float kMinRadiusSquared = 1e-20f;

double surface_area(const Bounds& box) {
  const Vec3f d = box.upper - box.lower;
  return 2 * static_cast<double>(d.x * d.y + d.y * d.z + d.z * d.x);
}

// What a group costs: emitters of like place, direction and strength should stand together.  [Conty18]
double cost(const EmitterBounds& bounds) {
  return static_cast<double>(bounds.intensity) * surface_area(bounds.box) * bounds.orientation_measure();
}

struct Cut {
  double cost = std::numeric_limits<double>::infinity();
  int axis = 0;
  int bucket = 0;  // the first of the second half
};

// Buckets of equal width along one axis of the centres' box.
struct Buckets {
  float lower, width;
  int axis;

  int operator()(const EmitterBounds& emitter) const {
    const float at = (emitter.box.center()[axis] - lower) / width * static_cast<float>(kBuckets);
    return std::clamp(static_cast<int>(at), 0, kBuckets - 1);
  }
};

}  // namespace

// A binary tree first; then its nodes are drawn together, a few levels to a block.
class EmitterTree::Builder {
 public:
  explicit Builder(const std::vector<EmitterBounds>& emitters) : emitters_(emitters), order_(emitters.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    build();
  }

  void draw_together(EmitterTree& tree) const {
    tree.leaves_.resize(emitters_.size());
    tree.blocks_.emplace_back();
    tree.parents_.emplace_back();
    std::vector<std::uint32_t> roots{0};  // of each block, in the binary tree
    for (std::uint32_t block = 0; block < tree.blocks_.size(); ++block) {
      const std::vector<std::uint32_t> lanes = children(roots[block]);
      for (std::uint32_t lane = 0; lane < lanes.size(); ++lane) {
        const Node& node = nodes_[lanes[lane]];
        tree.blocks_[block].set(lane, node.bounds);
        if (node.first_child == 0) {
          tree.blocks_[block].child[lane] = kLeaf | node.emitter;
          tree.leaves_[node.emitter] = {block, lane};
          continue;
        }
        tree.blocks_[block].child[lane] = static_cast<std::uint32_t>(tree.blocks_.size());
        roots.push_back(lanes[lane]);
        tree.parents_.push_back({block, lane});
        tree.blocks_.emplace_back();
      }
    }
  }

 private:
  struct Node {
    EmitterBounds bounds;
    std::uint32_t first_child = 0;  // of two that stand together; 0 in a leaf
    std::uint32_t emitter = 0;      // of a leaf
  };
  // A node for the emitters order_[begin, end).
  struct Task {
    std::uint32_t node;
    std::size_t begin, end;
  };

  void build() {
    std::vector<Task> tasks{{0, 0, order_.size()}};
    nodes_.resize(1);
    while (!tasks.empty()) {
      const Task task = tasks.back();
      tasks.pop_back();
      EmitterBounds bounds;
      for (std::size_t i = task.begin; i < task.end; ++i) bounds = EmitterBounds::join(bounds, emitters_[order_[i]]);
      nodes_[task.node].bounds = bounds;
      if (task.end - task.begin == 1) {
        nodes_[task.node].emitter = order_[task.begin];
        continue;
      }
      const std::size_t middle = split(task, bounds);
      const auto child = static_cast<std::uint32_t>(nodes_.size());
      nodes_[task.node].first_child = child;
      nodes_.resize(nodes_.size() + 2);
      tasks.push_back({child + 1, middle, task.end});
      tasks.push_back({child, task.begin, middle});
    }
  }

  // Up to kWidth nodes below that one: the widest and strongest group is replaced by its two halves while there is room.
  std::vector<std::uint32_t> children(std::uint32_t root) const {
    std::vector<std::uint32_t> lanes{root};
    while (lanes.size() < kWidth) {
      std::size_t widest = lanes.size();
      float most = -1;
      for (std::size_t i = 0; i < lanes.size(); ++i) {
        const Node& node = nodes_[lanes[i]];
        const float weight = sqr(node.bounds.box.radius()) * node.bounds.intensity;
        if (node.first_child == 0 || !(weight > most)) continue;
        most = weight;
        widest = i;
      }
      if (widest == lanes.size()) break;
      const std::uint32_t child = nodes_[lanes[widest]].first_child;
      lanes[widest] = child;
      lanes.insert(lanes.begin() + static_cast<std::ptrdiff_t>(widest) + 1, child + 1);
    }
    return lanes;
  }

  // Reorders the task's emitters and returns the first of its second half.
  std::size_t split(const Task& task, const EmitterBounds& bounds) {
    Bounds centers;
    for (std::size_t i = task.begin; i < task.end; ++i) centers.extend(emitters_[order_[i]].box.center());
    const Vec3f size = bounds.box.upper - bounds.box.lower;
    const float longest = std::max({size.x, size.y, size.z});
    Cut best;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(centers.upper[axis] > centers.lower[axis])) continue;
      const Buckets bucket_of{centers.lower[axis], centers.upper[axis] - centers.lower[axis], axis};
      // Thin slices of long boxes are dear.                                            [Conty18]
      const double stretch = static_cast<double>(longest / size[axis]);
      const Cut cut = cheapest_cut(task, bucket_of);
      if (cut.cost * stretch < best.cost) best = {cut.cost * stretch, axis, cut.bucket};
    }
    const auto first = order_.begin() + static_cast<std::ptrdiff_t>(task.begin);
    const auto last = order_.begin() + static_cast<std::ptrdiff_t>(task.end);
    if (best.cost > 0 && best.cost < std::numeric_limits<double>::infinity()) {
      const Buckets bucket_of{centers.lower[best.axis], centers.upper[best.axis] - centers.lower[best.axis], best.axis};
      const auto middle = std::partition(first, last, [&](std::uint32_t i) { return bucket_of(emitters_[i]) < best.bucket; });
      return static_cast<std::size_t>(middle - order_.begin());
    }
    // Nothing to weigh: points on a line or in one place, or without light. Half of them along the longest axis.
    const Vec3f extent = centers.upper - centers.lower;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const auto middle = first + (last - first) / 2;
    std::nth_element(first, middle, last, [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(emitters_[a].box.center()[axis], a) < std::pair(emitters_[b].box.center()[axis], b);
    });
    return static_cast<std::size_t>(middle - order_.begin());
  }

  Cut cheapest_cut(const Task& task, const Buckets& bucket_of) const {
    std::array<EmitterBounds, kBuckets> buckets;
    for (std::size_t i = task.begin; i < task.end; ++i) {
      EmitterBounds& bucket = buckets[static_cast<std::size_t>(bucket_of(emitters_[order_[i]]))];
      bucket = EmitterBounds::join(bucket, emitters_[order_[i]]);
    }
    std::array<double, kBuckets> above;  // cost of that bucket and all after it
    EmitterBounds sum;
    for (std::size_t i = kBuckets; i-- > 1;) {
      sum = EmitterBounds::join(sum, buckets[i]);
      above[i] = cost(sum);
    }
    Cut best;
    EmitterBounds below;
    for (std::size_t i = 1; i < kBuckets; ++i) {
      below = EmitterBounds::join(below, buckets[i - 1]);
      if (cost(below) + above[i] < best.cost) best = {cost(below) + above[i], bucket_of.axis, static_cast<int>(i)};
    }
    return best;
  }

  const std::vector<EmitterBounds>& emitters_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;  // the root first
};

void EmitterTree::Block::set(std::size_t lane, const EmitterBounds& bounds) {
  // A little wider, so that rounding leaves no point outside.
  const Vec3f center = bounds.box.center();
  center_x[lane] = center.x;
  center_y[lane] = center.y;
  center_z[lane] = center.z;
  radius_squared[lane] = std::max(sqr(bounds.box.radius() * (1 + 1e-5f)), kMinRadiusSquared);
  axis_x[lane] = bounds.axis.x;
  axis_y[lane] = bounds.axis.y;
  axis_z[lane] = bounds.axis.z;
  cos_spread[lane] = std::cos(bounds.spread);
  sin_spread[lane] = bounds.spread < kPi ? std::sin(bounds.spread) : 0.0f;
  cos_reach[lane] = bounds.reach < kPi / 2 ? std::cos(bounds.reach) : 0.0f;
  intensity[lane] = bounds.intensity;
  end = std::max(end, (lane / kVector + 1) * kVector);
}

EmitterTree::EmitterTree(const std::vector<EmitterBounds>& emitters) { Builder(emitters).draw_together(*this); }

}  // namespace fluxfarm
