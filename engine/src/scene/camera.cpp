#include "scene/camera.h"

#include <cmath>

#include "sampling/warp.h"

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
    : near_clip_(description.near_clip),
      far_clip_(description.far_clip),
      aperture_radius_(description.aperture_radius),
      focus_distance_(description.focus_distance),
      unit_(description.unit) {
  const Transform& to_world = description.to_world;
  origin_ = to_world.point({});
  axis_ = normalize(to_world.vector({0, 0, 1}));
  // Camera space has +x to the left, +y up: film x runs against x, film y runs against y.
  right_ = normalize(to_world.vector({-1, 0, 0}));
  down_ = normalize(to_world.vector({0, -1, 0}));
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  const float half_x = half_width(description, aspect), half_y = half_x / aspect;
  top_left_ = axis_ - half_x * right_ - half_y * down_;
  step_x_ = (2 * half_x / static_cast<float>(width)) * right_;
  step_y_ = (2 * half_y / static_cast<float>(height)) * down_;
}

Ray Camera::ray(float x, float y) const {
  const Vec3f d = top_left_ + x * step_x_ + y * step_y_;  // reaches the plane at distance 1
  const float scale = length(d);
  return {origin_, d / scale, near_clip_ * scale, far_clip_ * scale};
}

Vec3f Camera::lens_point(Vec2f u) const {
  const Vec2f p = square_to_uniform_disk(u);
  return (aperture_radius_ * p.x) * right_ + (aperture_radius_ * p.y) * down_;
}

Ray Camera::ray(float x, float y, Vec2f u) const {
  const Vec3f lens = lens_point(u);
  const Vec3f d = focus_distance_ * (top_left_ + x * step_x_ + y * step_y_) - lens;  // reaches the plane in focus
  const float reach = length(d);
  const float scale = reach / focus_distance_;
  return {origin_ + lens, d / reach, near_clip_ * scale, far_clip_ * scale};
}

std::optional<Camera::Projection> Camera::project(Vec3f point, Vec2f u) const {
  const float z = along_axis(point);
  if (!(z > near_clip_ && z < far_clip_)) return std::nullopt;
  const Vec3f lens = has_lens() ? lens_point(u) : Vec3f{};
  const Vec3f d = point - (origin_ + lens);
  // Where the line from the lens meets the plane in focus, brought to the plane at distance 1: there all lines through one point of
  // the film meet.
  const Vec3f seen = has_lens() ? d / z + lens / focus_distance_ : d / z;
  const Vec3f from_corner = seen - top_left_;
  const float step = length(step_x_), squared = length_squared(d);
  // A solid angle covers cos^-3 of its size on the plane at distance 1, where cos = z / |d|.
  const float distance = std::sqrt(squared);
  const float per_area = distance / (z * z * z * step * length(step_y_));
  return Projection{dot(from_corner, right_) / step, dot(from_corner, down_) / length(step_y_), origin_ + lens, near_clip_ / z,
                    per_area};
}

}  // namespace fluxfarm
