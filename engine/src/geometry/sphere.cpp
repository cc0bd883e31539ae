#include "geometry/sphere.h"

#include "math/frame.h"

namespace fluxfarm {

SurfacePoint Sphere::surface_point(const Ray& ray, const Hit& hit) const {
  // Projected back onto the sphere: the ray's own rounding grows with the distance travelled.
  const Vec3f outward = normalize(ray.origin + hit.t * ray.direction - center_);
  const Vec3f normal = inward_ ? -outward : outward;
  return {center_ + radius_ * outward, normal, normal};
}

Vec3f Sphere::tangent(const SurfacePoint& point, const Hit&) const {
  // Along the parallels around z; anything at the poles.
  const Vec3f local = axes_.to_local(point.position - center_);
  const float horizontal = std::sqrt(local.x * local.x + local.y * local.y);
  return horizontal > 0 ? axes_.to_world({-local.y / horizontal, local.x / horizontal, 0}) : axes_.s;
}

Vec2f Sphere::uv(const SurfacePoint& point, const Hit&) const {
  const Vec3f local = axes_.to_local(point.position - center_);
  const float horizontal = std::sqrt(local.x * local.x + local.y * local.y);
  return {turn_fraction(local.y, local.x), std::atan2(horizontal, local.z) * kInvPi};
}

Shape::UvDerivatives Sphere::uv_derivatives(const SurfacePoint& point, const Hit&) const {
  // Along the parallels, and down the meridians by half a turn.
  const Vec3f local = axes_.to_local(point.position - center_);
  const float horizontal = std::sqrt(local.x * local.x + local.y * local.y);
  const Vec2f out = horizontal > 0 ? Vec2f{local.x / horizontal, local.y / horizontal} : Vec2f{1, 0};
  return {axes_.to_world({-kTwoPi * local.y, kTwoPi * local.x, 0}),
          axes_.to_world({kPi * local.z * out.x, kPi * local.z * out.y, -kPi * horizontal})};
}

float Sphere::one_minus_cos(float d2) const {
  const float sin2 = radius_ * radius_ / d2;
  return sin2 / (1 + safe_sqrt(1 - sin2));
}

AreaSample Sphere::sample_area(Vec2f u) const {
  const float z = 1 - 2 * u.x;
  const float r = safe_sqrt(1 - z * z), phi = kTwoPi * u.y;
  const Vec3f outward{r * std::cos(phi), r * std::sin(phi), z};
  return {center_ + radius_ * outward, inward_ ? -outward : outward};
}

AreaBounds Sphere::area_bounds(const UnitBox& box) const {
  const float half_phi = kPi * box.size().y;
  Cone outward =
      polar_cone({std::acos(1 - 2 * box.lower.x), std::acos(1 - 2 * box.upper.x), kTwoPi * box.lower.y + half_phi, half_phi});
  outward.half_angle = std::min(outward.half_angle + 3e-4f, kPi);  // the digits that sample_area() loses near the poles
  const Cone normals{inward_ ? -outward.axis : outward.axis, outward.half_angle};
  if (outward.half_angle >= kPi / 3) return {{center_, radius_}, normals};
  return {{center_ + radius_ * outward.axis, 2 * radius_ * std::sin(0.5f * outward.half_angle)}, normals};
}

std::optional<ShapeSample> Sphere::sample(Vec3f reference, Vec2f u) const {
  const Vec3f to_center = center_ - reference;
  const float d2 = length_squared(to_center);
  if (!is_outside(d2)) {
    // From inside: uniform over the area.
    const auto [position, normal] = sample_area(u);
    const Vec3f d = position - reference;
    const float distance = length(d);
    if (!(distance > 0)) return std::nullopt;
    const Vec3f wi = d / distance;
    const float pdf_solid_angle = to_solid_angle(1 / area(), distance, dot(normal, wi));
    if (!(pdf_solid_angle > 0)) return std::nullopt;
    return ShapeSample{position, normal, wi, distance, pdf_solid_angle};
  }
  // Uniform in the cone that the sphere fills.
  const float phi = kTwoPi * u.y;
  const float d = std::sqrt(d2);
  const float cone = one_minus_cos(d2);
  const float one_minus_cos_theta = u.x * cone;
  const float cos_theta = 1 - one_minus_cos_theta;
  const float sin2_theta = one_minus_cos_theta * (2 - one_minus_cos_theta);
  const float sin_theta = safe_sqrt(sin2_theta);
  const Frame frame(to_center / d);
  const Vec3f wi = frame.to_world({sin_theta * std::cos(phi), sin_theta * std::sin(phi), cos_theta});
  const float distance = d * cos_theta - safe_sqrt(radius_ * radius_ - d2 * sin2_theta);
  const Vec3f outward = normalize(reference + distance * wi - center_);
  return ShapeSample{center_ + radius_ * outward, inward_ ? -outward : outward, wi, distance, 1 / (kTwoPi * cone)};
}

float Sphere::pdf(Vec3f reference, const SurfacePoint& point, std::uint32_t, Vec3f wi, float distance) const {
  const float d2 = length_squared(center_ - reference);
  if (!is_outside(d2)) return to_solid_angle(1 / area(), distance, dot(point.geometric_normal, wi));
  return 1 / (kTwoPi * one_minus_cos(d2));
}

Bounds Sphere::bounds() const {
  const Vec3f r{radius_, radius_, radius_};
  return {center_ - r, center_ + r};
}

}  // namespace fluxfarm
