#include "emitters/emitter_tree.h"

namespace fluxfarm {
namespace {

// An angle in [0, pi].
struct Angle {
  float cosine, sine;
};

// a - b, or 0 if b is larger.
Angle minus(Angle a, Angle b) {
  const bool none = a.cosine >= b.cosine;
  return {none ? 1.0f : a.cosine * b.cosine + a.sine * b.sine, none ? 0.0f : a.sine * b.cosine - a.cosine * b.sine};
}

Angle angle_of(float cosine) { return {cosine, safe_sqrt(1 - cosine * cosine)}; }

}  // namespace

// intensity cos(theta') cos(theta'_i) / distance^2, with each angle as small as some point of the ball can make it.   [Conty18]
// Without branches, so that the compiler makes vectors of the lanes.
EmitterTree::Importances EmitterTree::importances(const Block& block, const EmitterReference& reference) {
  const Vec3f p = reference.position, n = reference.normal;
  const bool from_all_around = n == Vec3f{};
  Importances result;
  for (std::size_t i = 0; i < kWidth; ++i) {
    const Vec3f d{block.center_x[i] - p.x, block.center_y[i] - p.y, block.center_z[i] - p.z};
    const float squared = length_squared(d), radius_squared = block.radius_squared[i];
    const Vec3f wi = d * (1 / std::sqrt(squared));
    const float sin_squared = std::min(radius_squared / squared, 1.0f);
    const Angle seen{std::sqrt(1 - sin_squared), std::sqrt(sin_squared)};

    const float cos_axis = -dot(Vec3f{block.axis_x[i], block.axis_y[i], block.axis_z[i]}, wi);
    const float leaving = minus(minus(angle_of(cos_axis), {block.cos_spread[i], block.sin_spread[i]}), seen).cosine;
    const float cosine = dot(n, wi);
    const float facing = minus(angle_of(reference.both_sides ? std::fabs(cosine) : cosine), seen).cosine;
    const float arriving = from_all_around ? 1.0f : facing;

    const float outside = leaving <= block.cos_reach[i] || arriving <= 0 ? 0.0f : leaving * arriving / squared;
    // From inside, any direction is possible; the bound stays finite.
    result.of[i] = block.intensity[i] * (squared <= radius_squared ? 1 / radius_squared : outside);
  }
  result.sum = 0;
  for (const float importance : result.of) result.sum += importance;
  return result;
}

std::optional<EmitterTree::Choice> EmitterTree::sample(const EmitterReference& reference, float u) const {
  float probability = 1;
  for (std::uint32_t block = 0;;) {
    const Importances importance = importances(blocks_[block], reference);
    if (!(importance.sum > 0)) return std::nullopt;
    const float target = u * importance.sum;
    float below = 0;  // the importances before the lane
    std::size_t lane = 0, last = 0;
    for (; lane < kWidth; ++lane) {
      if (!(importance.of[lane] > 0)) continue;
      last = lane;
      if (target < below + importance.of[lane]) break;
      below += importance.of[lane];
    }
    if (lane == kWidth) below -= importance.of[lane = last];  // rounding
    probability *= importance.of[lane] / importance.sum;
    u = std::clamp((target - below) / importance.of[lane], 0.0f, 0x1.fffffep-1f);
    const std::uint32_t child = blocks_[block].child[lane];
    if ((child & kLeaf) != 0) return Choice{child & ~kLeaf, probability};
    block = child;
  }
}

float EmitterTree::probability(const EmitterReference& reference, std::size_t index) const {
  float probability = 1;
  for (Place place = leaves_[index];; place = parents_[place.block]) {
    const Importances importance = importances(blocks_[place.block], reference);
    if (!(importance.of[place.lane] > 0)) return 0;
    probability *= importance.of[place.lane] / importance.sum;
    if (place.block == 0) return probability;
  }
}

}  // namespace fluxfarm
