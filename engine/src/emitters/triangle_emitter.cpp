#include "emitters/triangle_emitter.h"

namespace fluxfarm {

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
