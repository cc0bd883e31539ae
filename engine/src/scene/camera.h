// Perspective pinhole camera.
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
  // Distance of a point from the camera along the view axis, m.
  float depth(Vec3f point) const { return dot(point - origin_, axis_); }

 private:
  Vec3f origin_;
  Vec3f axis_;             // unit, the view direction
  Vec3f top_left_;         // from the origin to the film's corner on the plane at distance 1
  Vec3f step_x_, step_y_;  // one pixel on that plane
  float near_clip_, far_clip_;
};

}  // namespace fluxfarm
