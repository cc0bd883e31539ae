#include "emitters/emitter.h"

#include "math/frame.h"
#include "sampling/warp.h"

namespace fluxfarm {

EmissionSample emitted_by(const AreaSample& point, Rgb power, float area, bool both_sides, Vec2f u_direction) {
  Vec3f normal = point.normal;
  if (both_sides) {
    const bool back = u_direction.x >= 0.5f;
    u_direction.x = 2 * u_direction.x - (back ? 1.0f : 0.0f);
    if (back) normal = -normal;
  }
  const Vec3f direction = Frame(normal).to_world(square_to_cosine_hemisphere(u_direction));
  const float cosine = dot(normal, direction);
  const Rgb intensity = power * (cosine / (both_sides ? kTwoPi : kPi));
  return {{offset_point(point.position, normal), direction}, power, false, {area * cosine, 0}, false, intensity};
}

EmissionSample emitted_from_outside(Vec3f direction, Rgb irradiance, float solid_angle, Vec3f scene_center, float scene_radius,
                                    Vec2f u_point) {
  const Frame frame(direction);
  const Vec2f p = square_to_uniform_disk(u_point);
  const Vec3f origin = scene_center + scene_radius * (p.x * frame.s + p.y * frame.t - direction);
  return {{origin, direction}, irradiance * (kPi * scene_radius * scene_radius), false, {0, solid_angle}, true, irradiance};
}

std::optional<EmitterSample> AreaEmitter::sample(Vec3f reference, Vec2f u) const {
  return emitted_from(shape_.sample(reference, u), radiance_, both_sides_);
}

std::optional<EmitterBounds> AreaEmitter::bounds() const {
  EmitterBounds bounds;
  bounds.box = shape_.bounds();
  const std::optional<Vec3f> normal = shape_.plane_normal();
  if (normal) {
    bounds.axis = *normal;
    bounds.spread = both_sides_ ? kPi : 0;
    bounds.intensity = luminance(radiance_) * shape_.area();
  } else {
    bounds.intensity = luminance(radiance_) * shape_.area() / 4;  // seen from outside, a convex body shows a quarter of its area
  }
  return bounds;
}

std::optional<EmitterSample> PointEmitter::sample(Vec3f reference, Vec2f) const {
  const Vec3f d = position_ - reference;
  const float squared = length_squared(d);
  if (!(squared > 0)) return std::nullopt;
  const float distance = std::sqrt(squared);
  return EmitterSample{position_, {}, d / distance, distance, intensity_ / squared, 0, true};
}

std::optional<EmissionSample> PointEmitter::emit(Vec2f, Vec2f u_direction, Vec3f) const {
  return EmissionSample{{position_, square_to_uniform_sphere(u_direction)}, power(), true, {}, false, intensity_};
}

std::optional<EmitterBounds> PointEmitter::bounds() const {
  EmitterBounds bounds;
  bounds.box.extend(position_);
  bounds.intensity = luminance(intensity_);
  return bounds;
}

}  // namespace fluxfarm
