// Light from all around, infinitely far away, as an image tells it.
#pragma once

#include "emitters/emitter.h"
#include "emitters/lat_long_distribution.h"
#include "emitters/lat_long_image.h"
#include "math/frame.h"
#include "math/transform.h"

namespace fluxfarm {

class EnvmapEmitter final : public Emitter {
 public:
  // `to_world` turns, or mirrors, the image's directions; its scale and translation do not matter. `scene_radius` (m) is that of a
  // sphere around the scene.
  EnvmapEmitter(LatLongImage image, const Transform& to_world, float scene_radius);

  // The same from every reference point.
  std::optional<EmitterSample> sample(Vec3f reference, Vec2f u) const override;
  std::optional<EmissionSample> emit(Vec2f u_point, Vec2f u_direction, Vec3f scene_center) const override;
  EmissionBounds emission_bounds(const EmissionCell& cell, Vec3f scene_center) const override;
  Rgb power() const override;
  std::optional<EmitterBounds> bounds() const override { return std::nullopt; }

  // What arrives from `direction` (world, unit), W m^-2 sr^-1, and the density with which sample() chooses it, sr^-1.
  struct Arriving {
    Rgb radiance;
    float pdf_solid_angle = 0;
  };
  Arriving from(Vec3f direction) const;

 private:
  LatLongImage image_;
  LatLongDistribution distribution_;
  Frame frame_;  // the image's axes in the world; left-handed if to_world mirrors
  float scene_radius_;
};

}  // namespace fluxfarm
