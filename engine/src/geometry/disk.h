// Flat disk, sampled as a light by area.
#pragma once

#include "geometry/shape.h"
#include "math/frame.h"

namespace fluxfarm {

class Disk final : public Shape {
 public:
  // `normal` is unit and on the front side; `tangent` any unit vector in the plane; radius > 0, m. Texture coordinates run from
  // `tangent` counter-clockwise seen from the front, or clockwise if `clockwise`.
  Disk(Vec3f center, Vec3f normal, Vec3f tangent, float radius, bool clockwise = false);

  SurfacePoint surface_point(const Ray& ray, const Hit& hit) const override;
  Vec3f tangent(const SurfacePoint& point, const Hit& hit) const override;
  // u is the distance from the centre over the radius, v the angle over 2 pi.
  UvDerivatives uv_derivatives(const SurfacePoint& point, const Hit& hit) const override;
  Vec2f uv(const SurfacePoint& point, const Hit& hit) const override;
  std::optional<ShapeSample> sample(Vec3f reference, Vec2f u) const override;
  float pdf(Vec3f reference, const SurfacePoint& point, std::uint32_t primitive, Vec3f wi, float distance) const override;
  AreaSample sample_area(Vec2f u) const override;
  AreaBounds area_bounds(const UnitBox& box) const override;
  float area() const override { return kPi * radius_ * radius_; }
  Bounds bounds() const override;
  std::optional<Vec3f> plane_normal() const override { return normal_; }

  Vec3f center() const { return center_; }
  Vec3f normal() const { return normal_; }
  float radius() const { return radius_; }

 private:
  Vec3f center_, normal_, tangent_, bitangent_;
  float radius_;
  float turn_;  // -1 when clockwise
};

}  // namespace fluxfarm
