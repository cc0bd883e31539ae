// Parallelogram. As a light it is sampled by solid angle when its edges are at right angles and it looks large from the reference
// point, else by area.
#pragma once

#include "geometry/shape.h"

namespace fluxfarm {

class Rectangle final : public Shape {
 public:
  // Corner and the two edge vectors, m. The front side is that of cross(edge_u, edge_v), or the other one if `flipped`.
  Rectangle(Vec3f corner, Vec3f edge_u, Vec3f edge_v, bool flipped);

  SurfacePoint surface_point(const Ray& ray, const Hit& hit) const override;
  Vec3f tangent(const SurfacePoint&, const Hit&) const override { return axis_u_; }
  // From 0 at the corner to 1 along each edge.
  UvDerivatives uv_derivatives(const SurfacePoint& point, const Hit& hit) const override;
  Vec2f uv(const SurfacePoint& point, const Hit& hit) const override;
  std::optional<ShapeSample> sample(Vec3f reference, Vec2f u) const override;
  float pdf(Vec3f reference, const SurfacePoint& point, std::uint32_t primitive, Vec3f wi, float distance) const override;
  AreaSample sample_area(Vec2f u) const override;
  AreaBounds area_bounds(const UnitBox& box) const override;
  float area() const override { return area_; }
  Bounds bounds() const override;
  std::optional<Vec3f> plane_normal() const override { return normal_; }

  // The four corners, counter-clockwise seen against cross(edge_u, edge_v).
  Vec3f corner(int i) const;

 private:
  bool samples_solid_angle(Vec3f reference) const;

  Vec3f corner_, edge_u_, edge_v_;
  Vec3f axis_u_, axis_v_, normal_;  // unit; normal on the front side
  float length_u_, length_v_, area_;
  bool right_angled_;
};

}  // namespace fluxfarm
