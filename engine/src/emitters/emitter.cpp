#include "emitters/emitter.h"

namespace fluxfarm {

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

std::optional<EmitterBounds> PointEmitter::bounds() const {
  EmitterBounds bounds;
  bounds.box.extend(position_);
  bounds.intensity = luminance(intensity_);
  return bounds;
}

}  // namespace fluxfarm
