#include "emitters/envmap_emitter.h"

namespace fluxfarm {

EnvmapEmitter::EnvmapEmitter(LatLongImage image, const Transform& to_world, float scene_radius)
    : image_(std::move(image)), distribution_(image_), scene_radius_(scene_radius) {
  frame_.s = normalize(to_world.vector({1, 0, 0}));
  frame_.t = normalize(to_world.vector({0, 1, 0}));
  frame_.n = normalize(to_world.vector({0, 0, 1}));
}

std::optional<EmitterSample> EnvmapEmitter::sample(Vec3f, Vec2f u) const {
  const LatLongDistribution::Sample sample = distribution_.sample(image_, u);
  const Rgb radiance = image_.radiance(image_.cell(sample.direction));
  if (!(sample.pdf_solid_angle > 0) || radiance.is_black()) return std::nullopt;
  return EmitterSample{
      {}, {}, frame_.to_world(sample.direction), kDistant, radiance / sample.pdf_solid_angle, sample.pdf_solid_angle, false};
}

std::optional<EmissionSample> EnvmapEmitter::emit(Vec2f u_point, Vec2f u_direction, Vec3f scene_center) const {
  const std::optional<EmitterSample> seen = sample(scene_center, u_direction);
  if (!seen) return std::nullopt;
  return emitted_from_outside(-seen->wi, seen->weight, 1 / seen->pdf_solid_angle, scene_center, scene_radius_, u_point);
}

EmissionBounds EnvmapEmitter::emission_bounds(const EmissionCell& cell, Vec3f scene_center) const {
  const Cone seen = distribution_.cone(cell.direction);
  return bounds_emitted_from_outside({-frame_.to_world(seen.axis), seen.half_angle}, scene_center, scene_radius_, cell.point);
}

Rgb EnvmapEmitter::power() const {
  Rgb irradiance;  // summed over all directions
  for (int row = 0; row + 1 < image_.height; ++row) {
    Rgb sum;
    for (int column = 0; column < image_.width; ++column) sum += image_.mean(column, row);
    const float step = kPi / static_cast<float>(image_.height - 1);
    const float sin_integral = std::cos(step * static_cast<float>(row)) - std::cos(step * static_cast<float>(row + 1));
    irradiance += sum * (kTwoPi / static_cast<float>(image_.width) * sin_integral);
  }
  return irradiance * (kPi * scene_radius_ * scene_radius_);
}

EnvmapEmitter::Arriving EnvmapEmitter::from(Vec3f direction) const {
  const LatLongImage::Cell cell = image_.cell(frame_.to_local(direction));
  return {image_.radiance(cell), distribution_.pdf(cell)};
}

}  // namespace fluxfarm
