// Perspective camera with a pinhole or a thin lens.
//
// The lens is ideal: all rays through it that belong to a point of the film meet in one point of the plane in focus. Neither its
// glass nor its vignetting is modelled.
#pragma once

#include "math/ray.h"
#include "math/transform.h"
#include "scene/description.h"

namespace fluxfarm {

class Camera {
 public:
  // For a film of width x height pixels.
  Camera(const CameraDescription& description, int width, int height);

  // Ray through the point (x, y) of the film, in pixels from its top left corner. Starts at the near plane, ends at the far one.
  Ray ray(float x, float y) const;
  // The same through the lens, at a point chosen evenly over its area by u in [0,1)^2. The distances of the planes stay along the
  // view axis.
  Ray ray(float x, float y, Vec2f u) const;
  bool has_lens() const { return aperture_radius_ > 0; }
  // Distance of a point from the camera along the view axis, m.
  float depth(Vec3f point) const { return dot(point - origin_, axis_); }

 private:
  Vec3f origin_;
  Vec3f axis_;             // unit, the view direction
  Vec3f top_left_;         // from the origin to the film's corner on the plane at distance 1
  Vec3f step_x_, step_y_;  // one pixel on that plane
  Vec3f right_, down_;     // unit
  float near_clip_, far_clip_;
  float aperture_radius_, focus_distance_;
};

}  // namespace fluxfarm
