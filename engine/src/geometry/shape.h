// Shapes: triangle mesh, rectangle, disk, sphere. Each knows its surface at a hit and how to sample itself as seen from a point.
//
// Shapes are immutable. Finding hits is the business of accel/.
#pragma once

#include <cstdint>
#include <optional>

#include "geometry/surface_point.h"
#include "math/bounds.h"
#include "math/ray.h"
#include "math/rgb.h"
#include "math/vec.h"
#include "sampling/warp_bounds.h"

namespace fluxfarm {

// A point of a surface chosen as seen from a reference point.
struct ShapeSample {
  Vec3f position;
  Vec3f normal;                 // unit, front side
  Vec3f wi;                     // unit, from the reference point to `position`
  float distance = 0;           // m
  float pdf_solid_angle = 0;    // of wi, at the reference point, sr^-1
  std::uint32_t primitive = 0;  // triangle of the mesh; 0 for other shapes
};

// A point of a surface chosen evenly over its area.
struct AreaSample {
  Vec3f position;
  Vec3f normal;  // unit, front side
};

// Holds a part of a surface: its points lie in a ball, its normals (front side) in a cone.
struct AreaBounds {
  Ball points;
  Cone normals;
};

class Shape {
 public:
  virtual ~Shape() = default;

  // Surface at a hit of `ray` on this shape.
  virtual SurfacePoint surface_point(const Ray& ray, const Hit& hit) const = 0;

  // Direction of increasing u at a hit (world, unit, not necessarily orthogonal to the normal); frames of anisotropic materials.
  virtual Vec3f tangent(const SurfacePoint& point, const Hit& hit) const = 0;

  // Derivatives of the position by the texture coordinates at a hit (world, m).
  struct UvDerivatives {
    Vec3f dp_du, dp_dv;
  };
  virtual UvDerivatives uv_derivatives(const SurfacePoint& point, const Hit& hit) const = 0;

  // Texture coordinates at a hit, as Mitsuba 3 defines them for the shape.
  virtual Vec2f uv(const SurfacePoint& point, const Hit& hit) const = 0;

  // Colour at a hit, between those of the vertices; of a mesh that has them, black for all other shapes.
  virtual Rgb vertex_color(const Hit&) const { return {}; }

  // Chooses a point of the surface as seen from `reference`. Empty: nothing of it can be seen with that random number.
  virtual std::optional<ShapeSample> sample(Vec3f reference, Vec2f u) const = 0;

  // Density, at `reference`, with which sample() would choose the direction towards `point` (a hit of this shape at `distance` m in
  // the unit direction `wi`), sr^-1.
  virtual float pdf(Vec3f reference, const SurfacePoint& point, std::uint32_t primitive, Vec3f wi, float distance) const = 0;

  // Chooses a point of the surface, every part of its area alike; u in [0,1)^2.
  virtual AreaSample sample_area(Vec2f u) const = 0;
  // Holds all that sample_area() chooses for the u of a box.
  virtual AreaBounds area_bounds(const UnitBox& box) const = 0;

  virtual float area() const = 0;  // m^2
  virtual Bounds bounds() const = 0;
  // Of a flat shape, the normal (unit, front side). Empty: it has many.
  virtual std::optional<Vec3f> plane_normal() const { return std::nullopt; }
};

// Whether a flat light is sampled by solid angle: only when it looks large. Below this ratio of area to squared distance the solid
// angle is close to proportional to area cos / distance^2 all over it, and sampling by area costs less for little more variance
// (the ratio is a choice, not measured); near the plane of the light the solid angle vanishes and its closed forms lose their
// digits.
inline bool looks_large(float area, Vec3f centre, Vec3f normal, Vec3f reference) {
  constexpr float kFrom = 0.25f, kMinHeight = 1e-3f;
  const Vec3f d = reference - centre;
  const float height = dot(d, normal);
  return area > kFrom * length_squared(d) && height * height > kMinHeight * kMinHeight * area;
}

// The angle of (x, y) from the x axis as a part of a full turn, in [0,1].
inline float turn_fraction(float y, float x) {
  const float turn = std::atan2(y, x) * (1 / kTwoPi);
  return turn < 0 ? turn + 1 : turn;
}

// Density per solid angle of a point chosen with `pdf_area` (m^-2); 0 when the surface is seen edge-on.
inline float to_solid_angle(float pdf_area, float distance, float cos_at_light) {
  const float cosine = std::fabs(cos_at_light);
  return cosine > 0 ? pdf_area * distance * distance / cosine : 0.0f;
}

}  // namespace fluxfarm
