#include "scene/camera.h"

#include <cmath>

namespace fluxfarm {
namespace {

// Half the film's width on the plane at distance 1.
float half_width(const CameraDescription& camera, float aspect) {
  using Axis = CameraDescription::FovAxis;
  const float tangent = std::tan(camera.fov_degrees * (kPi / 360));
  switch (camera.fov_axis) {
    case Axis::kX: return tangent;
    case Axis::kY: return tangent * aspect;
    case Axis::kDiagonal: return tangent * aspect / std::sqrt(aspect * aspect + 1);
    case Axis::kSmaller: return aspect > 1 ? tangent * aspect : tangent;
    case Axis::kLarger: return aspect > 1 ? tangent : tangent * aspect;
  }
  return tangent;
}

}  // namespace

Camera::Camera(const CameraDescription& description, int width, int height)
    : near_clip_(description.near_clip), far_clip_(description.far_clip) {
  const Transform& to_world = description.to_world;
  origin_ = to_world.point({});
  axis_ = normalize(to_world.vector({0, 0, 1}));
  // Camera space has +x to the left, +y up: film x runs against x, film y runs against y.
  const Vec3f right = normalize(to_world.vector({-1, 0, 0})), down = normalize(to_world.vector({0, -1, 0}));
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  const float half_x = half_width(description, aspect), half_y = half_x / aspect;
  top_left_ = axis_ - half_x * right - half_y * down;
  step_x_ = (2 * half_x / static_cast<float>(width)) * right;
  step_y_ = (2 * half_y / static_cast<float>(height)) * down;
}

Ray Camera::ray(float x, float y) const {
  const Vec3f d = top_left_ + x * step_x_ + y * step_y_;  // reaches the plane at distance 1
  const float scale = length(d);
  return {origin_, d / scale, near_clip_ * scale, far_clip_ * scale};
}

}  // namespace fluxfarm
