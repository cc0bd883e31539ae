#include "integrators/photon/emission_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <utility>

#include "integrators/light_flux.h"
#include "integrators/photon/emission_sequence.h"

namespace fluxfarm {
namespace {

constexpr std::size_t kCells = 4096;       // at most, besides one for each emitter
constexpr double kFineEnough = 1.0 / 16;   // of the flux that is kept passes the balls: cells are fine enough
constexpr double kProbes = 1024;           // rays that tell how much of an emitter does so, spread over all of it
constexpr std::uint64_t kLeastProbes = 8;  // of a cell
constexpr float kSmallest = 0x1p-16f;      // edge of a cell

struct Node {
  std::uint32_t emitter;
  EmissionCell cell;
  std::vector<std::uint32_t> balls{};  // that it may meet
  Vec3f middle{};                      // of them
  int first = 0;                       // of the two numbers that spread the rays more
  double power = 0, waste = 0;         // about what it sends, and what of that passes them, W
  std::size_t order = 0;               // of making, to decide between equals

  bool operator<(const Node& other) const { return waste != other.waste ? waste < other.waste : order > other.order; }
};

// The numbers 0 and 1 choose the point, 2 and 3 the direction.
std::array<EmissionCell, 2> halves(const EmissionCell& cell, int number) {
  std::array<EmissionCell, 2> result{cell, cell};
  const auto edge = [number](Vec2f& p) -> float& { return number % 2 == 0 ? p.x : p.y; };
  const auto box = [number](EmissionCell& c) -> UnitBox& { return number < 2 ? c.point : c.direction; };
  UnitBox &first = box(result[0]), &second = box(result[1]);
  edge(first.upper) = edge(second.lower) = 0.5f * (edge(first.lower) + edge(first.upper));
  return result;
}

float edge_length(const EmissionCell& cell, int number) {
  const Vec2f size = number < 2 ? cell.point.size() : cell.direction.size();
  return number % 2 == 0 ? size.x : size.y;
}

// How far the choice of a point, and of a direction, moves rays at `place`, m.
std::pair<float, float> blur(const EmissionBounds& bounds, Vec3f place) {
  float point = 0, direction = 0;
  for (const auto& rays : bounds) {
    std::visit(
        [&](const auto& r) {
          point = std::max(point, r.point_blur(place));
          direction = std::max(direction, r.direction_blur(place));
        },
        rays);
  }
  return {point, direction};
}

class Cutter {
 public:
  Cutter(const Scene& scene, const std::vector<Ball>& balls)
      : scene_(scene), balls_(balls), powers_(ParticleSource::powers(scene)), kept_(powers_.size()), dropped_(powers_.size()) {}

  EmissionCells cut() {
    std::vector<std::uint32_t> all(balls_.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    for (std::uint32_t emitter = 0; emitter < powers_.size(); ++emitter) {
      if (powers_[emitter] > 0) add(emitter, {}, all);
    }
    std::vector<Node> done;
    while (!open_.empty()) {
      Node node = open_.top();
      open_.pop();
      const bool enough = wasted_ <= kFineEnough * power_ || open_.size() + done.size() >= kCells + powers_.size();
      const int number = enough ? -1 : number_to_halve(node);
      if (number < 0) {
        done.push_back(std::move(node));
      } else {
        power_ -= node.power;
        wasted_ -= node.waste;
        for (const EmissionCell& half : halves(node.cell, number)) add(node.emitter, half, node.balls);
      }
    }
    std::sort(done.begin(), done.end(),
              [](const Node& a, const Node& b) { return a.emitter != b.emitter ? a.emitter < b.emitter : a.order < b.order; });
    return result(done);
  }

 private:
  void add(std::uint32_t emitter, const EmissionCell& cell, const std::vector<std::uint32_t>& candidates) {
    const EmissionBounds bounds = ParticleSource::bounds(scene_, emitter, cell);
    Node node{.emitter = emitter, .cell = cell, .order = order_++};
    for (const std::uint32_t i : candidates) {
      const auto meets = [&](const auto& rays) { return std::visit([&](const auto& r) { return r.may_meet(balls_[i]); }, rays); };
      if (!std::any_of(bounds.begin(), bounds.end(), meets)) continue;
      node.balls.push_back(i);
      node.middle += balls_[i].center;
    }
    node.middle *= 1 / static_cast<float>(std::max<std::size_t>(node.balls.size(), 1));
    probe(node);
    if (node.balls.empty()) {
      dropped_[emitter] += node.power;
      return;
    }
    const auto [point, direction] = blur(bounds, node.middle);
    node.first = point > direction ? 0 : 2;
    power_ += node.power;
    wasted_ += node.waste;
    open_.push(std::move(node));
  }

  // Finds the power and the waste of a cell from a few of its rays.
  void probe(Node& node) const {
    const EmissionSequence sequence(node.order);
    const double measure = node.cell.measure();
    const std::uint64_t count = std::max(static_cast<std::uint64_t>(kProbes * measure), kLeastProbes);
    for (std::uint64_t i = 0; i < count; ++i) {
      const EmissionSequence::Point u = sequence.at(i);
      const auto emission =
          ParticleSource::emit_from(scene_, node.emitter, node.cell.point.at(u.place), node.cell.direction.at(u.direction));
      if (!emission) continue;
      const double power = static_cast<double>(mean(emission->flux)) * (measure / static_cast<double>(count));
      node.power += power;
      const auto met = [&](std::uint32_t ball) { return meets(emission->ray, balls_[ball]); };
      if (std::none_of(node.balls.begin(), node.balls.end(), met)) node.waste += power;
    }
  }

  static bool meets(const Ray& ray, const Ball& ball) {
    const Vec3f d = ball.center - ray.origin;
    const float along = dot(d, ray.direction), squared = length_squared(d), reach = sqr(ball.radius);
    return squared <= reach || (along > 0 && squared - sqr(along) <= reach);
  }

  // Of the two that spread the rays more, the one whose halves are narrower; of equals the longer one. -1: none can be halved.
  int number_to_halve(const Node& node) const {
    int best = -1;
    float narrowest = 0;
    for (int number = node.first; number < node.first + 2; ++number) {
      const float edge = edge_length(node.cell, number);
      if (edge <= kSmallest) continue;
      float spread = 0;
      for (const EmissionCell& half : halves(node.cell, number)) {
        const auto [p, d] = blur(ParticleSource::bounds(scene_, node.emitter, half), node.middle);
        spread = std::max(spread, p + d);
      }
      constexpr float kClearly = 0.99f;
      const bool longer = best >= 0 && kClearly * spread < narrowest && edge > edge_length(node.cell, best);
      if (best < 0 || spread < kClearly * narrowest || longer) {
        best = number;
        narrowest = spread;
      }
    }
    return best;
  }

  EmissionCells result(const std::vector<Node>& nodes) {
    EmissionCells cells;
    for (const Node& node : nodes) {
      kept_[node.emitter] += node.power;
      // The few rays may find nothing where there is a little.
      constexpr double kLeast = 0.05;
      cells.kept.push_back(
          {node.emitter, node.cell, (1 - kLeast) * node.power + kLeast * powers_[node.emitter] * node.cell.measure()});
    }
    for (std::size_t i = 0; i < powers_.size(); ++i) {
      if (dropped_[i] > 0) cells.left_out += powers_[i] * (dropped_[i] / (dropped_[i] + kept_[i]));
    }
    return cells;
  }

  const Scene& scene_;
  const std::vector<Ball>& balls_;
  const std::vector<double> powers_;    // W
  std::vector<double> kept_, dropped_;  // of each emitter, W by the probes
  std::priority_queue<Node> open_;
  double power_ = 0, wasted_ = 0;  // of all cells that are kept
  std::size_t order_ = 0;
};

}  // namespace

EmissionCells cells_that_meet(const Scene& scene, const std::vector<Ball>& balls) { return Cutter(scene, balls).cut(); }

}  // namespace fluxfarm
