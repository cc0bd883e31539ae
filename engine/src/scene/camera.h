// Perspective camera with a pinhole or a thin lens.
//
// The lens is ideal: all rays through it that belong to a point of the film meet in one point of the plane in focus. Neither its
// glass nor its vignetting is modelled.
#pragma once

#include <cmath>
#include <optional>

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
  // Where a point of the scene is seen on the film.
  struct Projection {
    float x = 0, y = 0;  // in pixels from the film's top left corner; may lie outside it
    Vec3f lens;          // the point of the lens, or the pinhole, through which it is seen
    float near = 0;      // part of the way from the lens to the point that lies before the near plane
    // Pixels of film per unit of area of a surface across the line from the lens, m^-2.
    float pixels_per_area = 0;
  };
  // `u` chooses the point of the lens evenly over its area; a pinhole does not look at it. Empty: the point is not between the
  // near and the far plane.
  std::optional<Projection> project(Vec3f point, Vec2f u) const;
  bool has_lens() const { return aperture_radius_ > 0; }
  // Of the pinhole, or the middle of the lens, world, m.
  Vec3f position() const { return origin_; }
  // What a pixel in the middle of the film sees, side in rad.
  float pixel_angle() const { return std::sqrt(length(cross(step_x_, step_y_))); }
  // Distance of a point from the camera along the view axis, m of the scene file.
  float depth(Vec3f point) const { return unit_ * along_axis(point); }

 private:
  float along_axis(Vec3f point) const { return dot(point - origin_, axis_); }
  Vec3f lens_point(Vec2f u) const;  // from the origin

  Vec3f origin_;
  Vec3f axis_;             // unit, the view direction
  Vec3f top_left_;         // from the origin to the film's corner on the plane at distance 1
  Vec3f step_x_, step_y_;  // one pixel on that plane
  Vec3f right_, down_;     // unit
  float near_clip_, far_clip_;
  float aperture_radius_, focus_distance_;
  float unit_;
};

}  // namespace fluxfarm
