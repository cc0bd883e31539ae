#include "geometry/disk.h"

namespace fluxfarm {

Disk::Disk(Vec3f center, Vec3f normal, Vec3f tangent, float radius, bool clockwise)
    : center_(center),
      normal_(normal),
      tangent_(tangent),
      bitangent_(cross(normal, tangent)),
      radius_(radius),
      turn_(clockwise ? -1.0f : 1.0f) {}

SurfacePoint Disk::surface_point(const Ray& ray, const Hit& hit) const {
  const Vec3f p = ray.origin + hit.t * ray.direction;
  return {p - dot(p - center_, normal_) * normal_, normal_, normal_};
}

Vec3f Disk::tangent(const SurfacePoint& point, const Hit&) const {
  // u runs outwards along the radius.
  const Vec3f d = point.position - center_;
  const float r = length(d);
  return r > 0 ? d / r : tangent_;
}

Vec2f Disk::uv(const SurfacePoint& point, const Hit&) const {
  const Vec3f d = point.position - center_;
  return {length(d) / radius_, turn_fraction(turn_ * dot(d, bitangent_), dot(d, tangent_))};
}

Shape::UvDerivatives Disk::uv_derivatives(const SurfacePoint& point, const Hit& hit) const {
  // Outwards along the radius, and once around.
  const Vec3f around = cross(normal_, point.position - center_) * (turn_ * kTwoPi);
  return {tangent(point, hit) * radius_, around};
}

AreaSample Disk::sample_area(Vec2f u) const {
  const float r = radius_ * std::sqrt(u.x);
  const float phi = kTwoPi * u.y;
  return {center_ + tangent_ * (r * std::cos(phi)) + bitangent_ * (r * std::sin(phi)), normal_};
}

AreaBounds Disk::area_bounds(const UnitBox& box) const {
  const float half_phi = kPi * box.size().y;
  const DiskBounds part =
      disk_bounds(Sector{std::sqrt(box.lower.x), std::sqrt(box.upper.x), kTwoPi * box.lower.y + half_phi, half_phi});
  const Vec3f center = center_ + radius_ * (part.center.x * tangent_ + part.center.y * bitangent_);
  return {{center, radius_ * part.radius}, {normal_, 0}};
}

std::optional<ShapeSample> Disk::sample(Vec3f reference, Vec2f u) const {
  const Vec3f position = sample_area(u).position;
  const Vec3f d = position - reference;
  const float distance = length(d);
  if (!(distance > 0)) return std::nullopt;
  const Vec3f wi = d / distance;
  const float pdf_solid_angle = to_solid_angle(1 / area(), distance, dot(normal_, wi));
  if (!(pdf_solid_angle > 0)) return std::nullopt;
  return ShapeSample{position, normal_, wi, distance, pdf_solid_angle};
}

float Disk::pdf(Vec3f, const SurfacePoint&, std::uint32_t, Vec3f wi, float distance) const {
  return to_solid_angle(1 / area(), distance, dot(normal_, wi));
}

Bounds Disk::bounds() const {
  // Half extent along each axis of a disk with that normal.
  const Vec3f half{radius_ * safe_sqrt(1 - normal_.x * normal_.x), radius_ * safe_sqrt(1 - normal_.y * normal_.y),
                   radius_ * safe_sqrt(1 - normal_.z * normal_.z)};
  return {center_ - half, center_ + half};
}

}  // namespace fluxfarm
