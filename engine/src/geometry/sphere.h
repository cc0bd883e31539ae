// Sphere, sampled as a light by the cone of directions in which it is seen.
#pragma once

#include "geometry/shape.h"
#include "math/frame.h"

namespace fluxfarm {

class Sphere final : public Shape {
 public:
  // `inward`: the front side is the inner one. radius > 0, m. `axes`: the sphere's own x, y and z axes in the world, for texture
  // coordinates and tangents; they may be left-handed.
  Sphere(Vec3f center, float radius, bool inward, const Frame& axes = {})
      : center_(center), radius_(radius), inward_(inward), axes_(axes) {}

  SurfacePoint surface_point(const Ray& ray, const Hit& hit) const override;
  Vec3f tangent(const SurfacePoint& point, const Hit& hit) const override;
  // u is the longitude over 2 pi, from the x axis towards y; v the colatitude over pi, from the z axis.
  UvDerivatives uv_derivatives(const SurfacePoint& point, const Hit& hit) const override;
  Vec2f uv(const SurfacePoint& point, const Hit& hit) const override;
  // From outside by solid angle, from inside (or on the surface) by area.
  std::optional<ShapeSample> sample(Vec3f reference, Vec2f u) const override;
  float pdf(Vec3f reference, const SurfacePoint& point, std::uint32_t primitive, Vec3f wi, float distance) const override;
  AreaSample sample_area(Vec2f u) const override;
  AreaBounds area_bounds(const UnitBox& box) const override;
  float area() const override { return 4 * kPi * radius_ * radius_; }
  Bounds bounds() const override;

  Vec3f center() const { return center_; }
  float radius() const { return radius_; }

 private:
  // 1 - cosine of the cone's half angle as seen from squared distance d2 to the centre, without cancellation.
  float one_minus_cos(float d2) const;
  bool is_outside(float d2) const { return d2 > radius_ * radius_ * 1.0002f; }

  Vec3f center_;
  float radius_;
  bool inward_;
  Frame axes_;
};

}  // namespace fluxfarm
