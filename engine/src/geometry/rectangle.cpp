#include "geometry/rectangle.h"

#include "geometry/spherical_rectangle.h"

namespace fluxfarm {
namespace {

// Of a hit, in lengths of the edges. Two triangles: corners 0 1 2 and 0 2 3.
Vec2f place(const Hit& hit) {
  const auto second = static_cast<float>(hit.primitive);
  return {hit.u + (1 - second) * hit.v, hit.v + second * hit.u};
}

}  // namespace

Rectangle::Rectangle(Vec3f corner, Vec3f edge_u, Vec3f edge_v, bool flipped)
    : corner_(corner), edge_u_(edge_u), edge_v_(edge_v), length_u_(length(edge_u)), length_v_(length(edge_v)) {
  const Vec3f n = cross(edge_u, edge_v);
  area_ = length(n);
  axis_u_ = edge_u / length_u_;
  axis_v_ = edge_v / length_v_;
  normal_ = flipped ? -(n / area_) : n / area_;
  right_angled_ = std::fabs(dot(axis_u_, axis_v_)) < 1e-4f;
}

SurfacePoint Rectangle::surface_point(const Ray&, const Hit& hit) const {
  const Vec2f p = place(hit);
  return {corner_ + p.x * edge_u_ + p.y * edge_v_, normal_, normal_};
}

Vec2f Rectangle::uv(const SurfacePoint&, const Hit& hit) const { return place(hit); }

Shape::UvDerivatives Rectangle::uv_derivatives(const SurfacePoint&, const Hit&) const { return {edge_u_, edge_v_}; }

bool Rectangle::samples_solid_angle(Vec3f reference) const {
  return right_angled_ && looks_large(area_, corner_ + 0.5f * (edge_u_ + edge_v_), normal_, reference);
}

std::optional<ShapeSample> Rectangle::sample(Vec3f reference, Vec2f u) const {
  Vec3f position;
  float pdf_solid_angle = 0;
  if (samples_solid_angle(reference)) {
    const SphericalRectangle seen(corner_, axis_u_, axis_v_, length_u_, length_v_, reference);
    const Vec2f p = seen.sample(u);
    position = corner_ + p.x * axis_u_ + p.y * axis_v_;
    pdf_solid_angle = 1 / seen.solid_angle();
  } else {
    position = sample_area(u).position;
  }
  const Vec3f d = position - reference;
  const float distance = length(d);
  if (!(distance > 0)) return std::nullopt;
  const Vec3f wi = d / distance;
  if (pdf_solid_angle == 0) pdf_solid_angle = to_solid_angle(1 / area_, distance, dot(normal_, wi));
  if (!(pdf_solid_angle > 0)) return std::nullopt;
  return ShapeSample{position, normal_, wi, distance, pdf_solid_angle};
}

float Rectangle::pdf(Vec3f reference, const SurfacePoint&, std::uint32_t, Vec3f wi, float distance) const {
  if (samples_solid_angle(reference)) {
    return 1 / SphericalRectangle(corner_, axis_u_, axis_v_, length_u_, length_v_, reference).solid_angle();
  }
  return to_solid_angle(1 / area_, distance, dot(normal_, wi));
}

AreaSample Rectangle::sample_area(Vec2f u) const { return {corner_ + u.x * edge_u_ + u.y * edge_v_, normal_}; }

AreaBounds Rectangle::area_bounds(const UnitBox& box) const {
  const Vec2f s = box.size();
  const Vec3f u = 0.5f * s.x * edge_u_, v = 0.5f * s.y * edge_v_;
  const Vec3f center = corner_ + box.lower.x * edge_u_ + box.lower.y * edge_v_ + u + v;
  return {{center, std::max(length(u + v), length(u - v))}, {normal_, 0}};
}

Vec3f Rectangle::corner(int i) const {
  return corner_ + (i == 1 || i == 2 ? edge_u_ : Vec3f{}) + (i == 2 || i == 3 ? edge_v_ : Vec3f{});
}

Bounds Rectangle::bounds() const {
  Bounds result;
  for (int i = 0; i < 4; ++i) result.extend(corner(i));
  return result;
}

}  // namespace fluxfarm
