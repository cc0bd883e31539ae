#include "emitters/emitter.h"

namespace fluxfarm {

std::optional<EmitterSample> AreaEmitter::sample(Vec3f reference, Vec2f u) const {
  const std::optional<ShapeSample> s = shape_.sample(reference, u);
  if (!s) return std::nullopt;
  const bool back = dot(s->normal, s->wi) >= 0;
  if (back && !both_sides_) return std::nullopt;
  return EmitterSample{
      s->position, back ? -s->normal : s->normal, s->wi, s->distance, radiance_ / s->pdf_solid_angle, s->pdf_solid_angle, false};
}

std::optional<EmitterSample> PointEmitter::sample(Vec3f reference, Vec2f) const {
  const Vec3f d = position_ - reference;
  const float squared = length_squared(d);
  if (!(squared > 0)) return std::nullopt;
  const float distance = std::sqrt(squared);
  return EmitterSample{position_, {}, d / distance, distance, intensity_ / squared, 0, true};
}

}  // namespace fluxfarm
