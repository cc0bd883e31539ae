// A triangle mesh placed in the world without a copy of it: many instances share one mesh in its own space.
//
// Corners are transformed at each hit in double precision and rounded once, so a hit has the geometry that a copied mesh would
// have. Instances are no lights: sampling one by area would need a table for each transform. Emissive meshes are copied instead.
#pragma once

#include "geometry/triangle_mesh.h"
#include "math/transform.h"

namespace fluxfarm {

class MeshInstance final : public Shape {
 public:
  // `mesh` in object space, which must outlive this; `mesh_bounds` its box. `to_world` must be invertible. The front stays on the
  // side that it has on the mesh, also under a mirroring transform.
  MeshInstance(const TriangleMesh& mesh, const Bounds& mesh_bounds, const Transform& to_world);

  SurfacePoint surface_point(const Ray& ray, const Hit& hit) const override;
  Vec3f tangent(const SurfacePoint& point, const Hit& hit) const override;
  Vec2f uv(const SurfacePoint& point, const Hit& hit) const override { return mesh_.uv(point, hit); }
  UvDerivatives uv_derivatives(const SurfacePoint& point, const Hit& hit) const override;
  Rgb vertex_color(const Hit& hit) const override { return mesh_.vertex_color(hit); }
  // An instance is never an emitter: asking is a broken invariant.
  std::optional<ShapeSample> sample(Vec3f reference, Vec2f u) const override;
  float pdf(Vec3f reference, const SurfacePoint& point, std::uint32_t primitive, Vec3f wi, float distance) const override;
  AreaSample sample_area(Vec2f u) const override;
  AreaBounds area_bounds(const UnitBox& box) const override;
  float area() const override;
  // The box around the transformed box of the mesh: holds the instance, not always tightly.
  Bounds bounds() const override;

  const TriangleMesh& mesh() const { return mesh_; }
  const Transform& to_world() const { return to_world_; }

 private:
  const TriangleMesh& mesh_;
  Bounds mesh_bounds_;
  Transform to_world_;
  float side_;  // -1 if to_world mirrors, or the mesh is flipped: the normal of the transformed corners lies on the back
};

}  // namespace fluxfarm
