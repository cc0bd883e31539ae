#include "geometry/mesh_instance.h"

#include "support/check.h"

namespace fluxfarm {

MeshInstance::MeshInstance(const TriangleMesh& mesh, const Bounds& mesh_bounds, const Transform& to_world)
    : mesh_(mesh), mesh_bounds_(mesh_bounds), to_world_(to_world), side_(to_world.determinant() < 0 ? -1.0f : 1.0f) {
  if (mesh.flipped()) side_ = -side_;
}

SurfacePoint MeshInstance::surface_point(const Ray&, const Hit& hit) const {
  const auto [a, b, c] = mesh_.corners(hit.primitive);
  const Vec3f p = to_world_.point(a), e1 = to_world_.point(b) - p, e2 = to_world_.point(c) - p;
  SurfacePoint point;
  point.position = p + hit.u * e1 + hit.v * e2;
  point.geometric_normal = side_ * normalize(cross(e1, e2));
  point.shading_normal = point.geometric_normal;
  const Vec3f n = mesh_.vertex_normal(hit);
  if (n == Vec3f{}) return point;
  const Vec3f world = to_world_.normal(n);
  const float squared = length_squared(world);
  if (squared > 0 && std::isfinite(squared)) point.shading_normal = (1 / std::sqrt(squared)) * world;
  return point;
}

Vec3f MeshInstance::tangent(const SurfacePoint& point, const Hit& hit) const {
  return normalize(to_world_.vector(mesh_.tangent(point, hit)));
}

Shape::UvDerivatives MeshInstance::uv_derivatives(const SurfacePoint& point, const Hit& hit) const {
  const auto [dp_du, dp_dv] = mesh_.uv_derivatives(point, hit);
  return {to_world_.vector(dp_du), to_world_.vector(dp_dv)};
}

std::optional<ShapeSample> MeshInstance::sample(Vec3f, Vec2f) const {
  FLUXFARM_CHECK(false, "an instance of a mesh is never sampled as a light");
  return std::nullopt;
}

float MeshInstance::pdf(Vec3f, const SurfacePoint&, std::uint32_t, Vec3f, float) const {
  FLUXFARM_CHECK(false, "an instance of a mesh is never sampled as a light");
  return 0;
}

AreaSample MeshInstance::sample_area(Vec2f) const {
  FLUXFARM_CHECK(false, "an instance of a mesh is never sampled as a light");
  return {};
}

AreaBounds MeshInstance::area_bounds(const UnitBox&) const {
  FLUXFARM_CHECK(false, "an instance of a mesh is never sampled as a light");
  return {};
}

float MeshInstance::area() const {
  double total = 0;
  for (std::size_t i = 0; i < mesh_.triangles(); ++i) {
    const auto [a, b, c] = mesh_.corners(static_cast<std::uint32_t>(i));
    total += 0.5 * static_cast<double>(length(to_world_.normal(cross(b - a, c - a))));
  }
  return static_cast<float>(total);
}

Bounds MeshInstance::bounds() const {
  Bounds result;
  for (int corner = 0; corner < 8; ++corner) {
    result.extend(to_world_.point({corner & 1 ? mesh_bounds_.upper.x : mesh_bounds_.lower.x,
                                   corner & 2 ? mesh_bounds_.upper.y : mesh_bounds_.lower.y,
                                   corner & 4 ? mesh_bounds_.upper.z : mesh_bounds_.lower.z}));
  }
  return result;
}

}  // namespace fluxfarm
