#include "emitters/emitter_bounds.h"

namespace fluxfarm {
namespace {

// Rotates a unit vector about a unit axis across it (Rodrigues).
Vec3f rotate_across(Vec3f v, Vec3f axis, float angle) { return v * std::cos(angle) + cross(axis, v) * std::sin(angle); }

// Widens the cone of `result` until it holds that of `other`.  [Conty18]
void join_cones(EmitterBounds& result, const EmitterBounds& other) {
  EmitterBounds wide = result, narrow = other;
  if (wide.spread < narrow.spread) std::swap(wide, narrow);
  const Vec3f normal = cross(wide.axis, narrow.axis);
  const float sine = length(normal);
  const float between = std::atan2(sine, dot(wide.axis, narrow.axis));
  if (std::min(between + narrow.spread, kPi) <= wide.spread) {
    result.axis = wide.axis;
    result.spread = wide.spread;
    return;
  }
  // Rounding must not leave a normal outside.
  constexpr float kMargin = 1e-4f;
  const float spread = 0.5f * (wide.spread + between + narrow.spread) + kMargin;
  if (spread >= kPi || !(sine > 0)) {
    result.axis = wide.axis;
    result.spread = kPi;
    return;
  }
  result.axis = normalize(rotate_across(wide.axis, normal / sine, spread - wide.spread));
  result.spread = spread;
}

}  // namespace

EmitterBounds EmitterBounds::join(const EmitterBounds& a, const EmitterBounds& b) {
  if (a.box.empty()) return b;
  if (b.box.empty()) return a;
  EmitterBounds result = a;
  result.box.extend(b.box.lower);
  result.box.extend(b.box.upper);
  join_cones(result, b);
  result.reach = std::max(a.reach, b.reach);
  result.intensity = a.intensity + b.intensity;
  return result;
}

double EmitterBounds::orientation_measure() const {
  // 2 pi times the integral of sin(t) up to theta_o and of cos(t - theta_o) sin(t) from there to theta_w.  [Conty18]
  const double o = static_cast<double>(spread), w = std::min(o + static_cast<double>(reach), M_PI);
  return 2 * M_PI * (1 - std::cos(o)) + M_PI / 2 * (2 * (w - o) * std::sin(o) + std::cos(o) - std::cos(o - 2 * w));
}

}  // namespace fluxfarm
