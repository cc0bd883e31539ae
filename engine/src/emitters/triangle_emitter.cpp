#include "emitters/triangle_emitter.h"

#include "support/check.h"

namespace fluxfarm {

std::optional<EmissionSample> TriangleEmitter::emit(Vec2f, Vec2f, Vec3f) const {
  FLUXFARM_CHECK(false, "light is followed from a mesh as a whole, never from one triangle of it");
  return std::nullopt;
}

EmissionBounds TriangleEmitter::emission_bounds(const EmissionCell&, Vec3f) const {
  FLUXFARM_CHECK(false, "light is followed from a mesh as a whole, never from one triangle of it");
  return {};
}

std::optional<EmitterBounds> TriangleEmitter::bounds() const {
  const auto [a, b, c] = mesh_->corners(triangle_);
  EmitterBounds bounds;
  for (const Vec3f corner : {a, b, c}) bounds.box.extend(corner);
  bounds.axis = mesh_->triangle_normal(triangle_);
  bounds.spread = both_sides_ ? kPi : 0;
  bounds.intensity = luminance(radiance_) * mesh_->triangle_area(triangle_);
  return bounds;
}

}  // namespace fluxfarm
