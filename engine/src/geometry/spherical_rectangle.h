// A rectangle seen from a point as a region of the sphere of directions, sampled uniformly over its solid angle.
//
// [Urena13] C. Urena, M. Fajardo, A. King, "An Area-Preserving Parametrization for Spherical Rectangles", EGSR 2013.
#pragma once

#include "math/vec.h"

namespace fluxfarm {

class SphericalRectangle {
 public:
  // Corner s, unit axes x and y at right angles, edge lengths in m, seen from `reference`, which is not in the plane.
  SphericalRectangle(Vec3f s, Vec3f axis_x, Vec3f axis_y, float length_x, float length_y, Vec3f reference);

  float solid_angle() const { return solid_angle_; }  // sr

  // Point of the rectangle, as coordinates along the two axes from s, whose direction is uniform over the solid angle.
  Vec2f sample(Vec2f u) const;

 private:
  float x0_, x1_, y0_, y1_, z0_;  // rectangle in a frame at the reference point, plane at z0 < 0
  float b0_, b1_, k_;
  float solid_angle_;
};

}  // namespace fluxfarm
