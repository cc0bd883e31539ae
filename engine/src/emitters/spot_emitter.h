// Spot light: a point that shines into a cone, with Mitsuba 3's fall-off, which is linear in the angle.
#pragma once

#include "emitters/emitter.h"

namespace fluxfarm {

class SpotEmitter final : public Emitter {
 public:
  // From `position` along `axis` (world, unit). `intensity` (W sr^-1) holds within `beam_width` of the axis and falls to zero at
  // `cutoff_angle`; both in radians, 0 <= beam_width <= cutoff_angle < pi.
  SpotEmitter(Vec3f position, Vec3f axis, Rgb intensity, float cutoff_angle, float beam_width)
      : position_(position), axis_(axis), intensity_(intensity), cutoff_angle_(cutoff_angle), beam_width_(beam_width) {}

  std::optional<EmitterSample> sample(Vec3f reference, Vec2f u) const override;
  std::optional<EmissionSample> emit(Vec2f u_point, Vec2f u_direction, Vec3f scene_center) const override;
  EmissionBounds emission_bounds(const EmissionCell& cell, Vec3f scene_center) const override;
  Rgb power() const override;
  std::optional<EmitterBounds> bounds() const override;

  // Share of the full intensity that leaves in `direction` (world, unit).
  float falloff(Vec3f direction) const;

 private:
  float cap_height() const;  // 1 - cos(cutoff) with all its digits: narrow cones have few in the cosine

  Vec3f position_, axis_;
  Rgb intensity_;
  float cutoff_angle_, beam_width_;
};

}  // namespace fluxfarm
