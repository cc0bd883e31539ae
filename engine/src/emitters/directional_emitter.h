// Parallel light from infinitely far away, as of the sun.
#pragma once

#include "emitters/emitter.h"

namespace fluxfarm {

class DirectionalEmitter final : public Emitter {
 public:
  // Light that travels in `direction` (world, unit) and brings `irradiance` (W m^-2) to a surface across it. `scene_radius` (m)
  // is that of a sphere around the scene.
  DirectionalEmitter(Vec3f direction, Rgb irradiance, float scene_radius)
      : direction_(direction), irradiance_(irradiance), scene_radius_(scene_radius) {}

  std::optional<EmitterSample> sample(Vec3f, Vec2f) const override {
    return EmitterSample{{}, {}, -direction_, kDistant, irradiance_, 0, true};
  }
  std::optional<EmissionSample> emit(Vec2f u_point, Vec2f, Vec3f scene_center) const override {
    EmissionSample sample = emitted_from_outside(direction_, irradiance_, 0, scene_center, scene_radius_, u_point);
    sample.delta = true;
    return sample;
  }
  EmissionBounds emission_bounds(const EmissionCell& cell, Vec3f scene_center) const override {
    return bounds_emitted_from_outside({direction_, 0}, scene_center, scene_radius_, cell.point);
  }
  std::optional<EmitterBounds> bounds() const override { return std::nullopt; }
  // What falls on the disk that the scene's sphere shows to the light.
  Rgb power() const override { return irradiance_ * (kPi * scene_radius_ * scene_radius_); }

 private:
  Vec3f direction_;
  Rgb irradiance_;
  float scene_radius_;
};

}  // namespace fluxfarm
