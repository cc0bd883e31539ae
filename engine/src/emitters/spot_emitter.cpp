#include "emitters/spot_emitter.h"

#include "math/frame.h"
#include "sampling/warp.h"

namespace fluxfarm {

std::optional<EmitterSample> SpotEmitter::sample(Vec3f reference, Vec2f) const {
  const Vec3f d = position_ - reference;
  const float squared = length_squared(d);
  if (!(squared > 0)) return std::nullopt;
  const float distance = std::sqrt(squared);
  const Vec3f wi = d / distance;
  const float share = falloff(-wi);
  if (!(share > 0)) return std::nullopt;
  return EmitterSample{position_, {}, wi, distance, intensity_ * (share / squared), 0, true};
}

float SpotEmitter::cap_height() const { return 2 * sqr(std::sin(0.5f * cutoff_angle_)); }

EmissionBounds SpotEmitter::emission_bounds(const EmissionCell& cell, Vec3f) const {
  const Cone local = cap_cone(cell.direction, cap_height());
  return {NearRays({position_, 0}, {Frame(axis_).to_world(local.axis), local.half_angle})};
}

std::optional<EmissionSample> SpotEmitter::emit(Vec2f, Vec2f u_direction, Vec3f) const {
  const float height = cap_height();
  const Vec3f direction = Frame(axis_).to_world(square_to_uniform_cap(u_direction, height));
  const float share = falloff(direction);
  if (!(share > 0)) return std::nullopt;
  return EmissionSample{{position_, direction}, intensity_ * (share * kTwoPi * height), true, {}, false, intensity_ * share};
}

float SpotEmitter::falloff(Vec3f direction) const {
  // Both sine and cosine: the arc cosine alone has few digits near the axis, where narrow beams live.
  const float angle = std::atan2(length(cross(axis_, direction)), dot(axis_, direction));
  if (angle <= beam_width_) return 1;
  return angle < cutoff_angle_ ? (cutoff_angle_ - angle) / (cutoff_angle_ - beam_width_) : 0.0f;
}

std::optional<EmitterBounds> SpotEmitter::bounds() const {
  EmitterBounds bounds;
  bounds.box.extend(position_);
  bounds.axis = axis_;
  // Light leaves up to spread + reach; the reach may not pass a right angle, where its cosine ends.
  bounds.spread = std::max(beam_width_, cutoff_angle_ - kPi / 2);
  bounds.reach = cutoff_angle_ - bounds.spread;
  bounds.intensity = luminance(intensity_);
  return bounds;
}

Rgb SpotEmitter::power() const {
  // 2 pi times the integral of falloff sin(theta); the beam's part and the slope's part together. In double precision: both
  // differences are small for narrow cones.
  const double cutoff = static_cast<double>(cutoff_angle_), beam = static_cast<double>(beam_width_);
  const double mean_cosine = cutoff > beam ? (std::sin(cutoff) - std::sin(beam)) / (cutoff - beam) : std::cos(cutoff);
  return intensity_ * (kTwoPi * static_cast<float>(1 - mean_cosine));
}

}  // namespace fluxfarm
