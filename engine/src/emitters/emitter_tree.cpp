#include "emitters/emitter_tree.h"

namespace fluxfarm {
namespace {

// Cosine and sine of an angle in [0, pi].
struct Angle {
  float cosine, sine;
};

// a - b, or 0 if b is larger.
inline Angle minus(Angle a, Angle b) {
  const float cosine = a.cosine * b.cosine + a.sine * b.sine, sine = a.sine * b.cosine - a.cosine * b.sine;
  return {a.cosine >= b.cosine ? 1.0f : cosine, a.cosine >= b.cosine ? 0.0f : sine};
}

inline Angle angle_of(float cosine) {
  const float squared = 1 - cosine * cosine;
  return {cosine, std::sqrt(squared > 0 ? squared : 0.0f)};
}

}  // namespace

// intensity cos(theta') cos(theta'_i) / distance^2, with each angle as small as some point of the ball can make it.   [Conty18]
// Without branches, so that the compiler makes vectors of the lanes.
EmitterTree::Importances EmitterTree::importances(const Block& block, const EmitterReference& reference) {
  const Vec3f p = reference.position, n = reference.normal;
  // Added to the cosine at the reference: enough that all directions are alike.
  const float all_around = n == Vec3f{} ? 1.0f : 0.0f;
  const float other_side = reference.both_sides ? -1.0f : 1.0f;  // the factor of a cosine below zero
  Importances result;
  const auto weigh = [&](std::size_t i) {
    const Vec3f d{block.center_x[i] - p.x, block.center_y[i] - p.y, block.center_z[i] - p.z};
    const float squared = length_squared(d), radius_squared = block.radius_squared[i];
    // From inside, any direction is possible; the bound stays finite.
    const bool inside = squared <= radius_squared;
    const float bounded = inside ? radius_squared : squared;
    const Vec3f wi = d * (1 / std::sqrt(bounded));
    const float sin_squared = radius_squared / bounded;
    const Angle seen{std::sqrt(1 - sin_squared), std::sqrt(sin_squared)};

    const float cos_axis = -(block.axis_x[i] * wi.x + block.axis_y[i] * wi.y + block.axis_z[i] * wi.z);
    const float leaving = minus(minus(angle_of(cos_axis), {block.cos_spread[i], block.sin_spread[i]}), seen).cosine;
    const float cosine = dot(n, wi) + all_around;
    const float arriving = minus(angle_of(cosine < 0 ? cosine * other_side : cosine), seen).cosine;

    const float from_outside = leaving > block.cos_reach[i] ? leaving * (arriving > 0 ? arriving : 0.0f) : 0.0f;
    result.of[i] = block.intensity[i] / bounded * (inside ? 1.0f : from_outside);
  };
  for (std::size_t begin = 0; begin < block.end; begin += kVector) {
    for (std::size_t i = 0; i < kVector; ++i) weigh(begin + i);
  }
  result.sum = 0;
  for (std::size_t i = 0; i < block.end; ++i) result.sum += result.of[i];
  return result;
}

std::optional<EmitterTree::Choice> EmitterTree::sample(const EmitterReference& reference, float u) const {
  float probability = 1;
  for (std::uint32_t block = 0;;) {
    const Importances importance = importances(blocks_[block], reference);
    const std::size_t end = blocks_[block].end;
    if (!(importance.sum > 0)) return std::nullopt;
    const float target = u * importance.sum;
    float below = 0;  // the importances before the lane
    std::size_t lane = 0, last = 0;
    for (; lane < end; ++lane) {
      if (!(importance.of[lane] > 0)) continue;
      last = lane;
      if (target < below + importance.of[lane]) break;
      below += importance.of[lane];
    }
    if (lane == end) below -= importance.of[lane = last];  // rounding
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
