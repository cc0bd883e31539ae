// A triangle seen from a point as a region of the sphere of directions, sampled uniformly over its solid angle.
//
// [Arvo95] J. Arvo, "Stratified Sampling of Spherical Triangles", SIGGRAPH 1995.
#pragma once

#include "math/vec.h"

namespace fluxfarm {

class SphericalTriangle {
 public:
  // Corners in world space, seen from `reference`, which is not in their plane.
  SphericalTriangle(Vec3f a, Vec3f b, Vec3f c, Vec3f reference);

  float solid_angle() const { return solid_angle_; }  // sr

  // Unit direction from the reference point, uniform over the solid angle.
  Vec3f sample(Vec2f u) const;

 private:
  Vec3f a_, b_, c_;              // unit directions to the corners
  float cos_alpha_, sin_alpha_;  // inner angle at a
  float solid_angle_;
};

}  // namespace fluxfarm
