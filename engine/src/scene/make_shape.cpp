#include "scene/make_shape.h"

#include "support/error.h"

namespace fluxfarm {
namespace {

std::unique_ptr<TriangleMesh> make(const MeshDescription& mesh, bool flipped, bool emissive) {
  return std::make_unique<TriangleMesh>(TriangleMesh::Data{mesh.positions, mesh.normals, mesh.uvs, mesh.indices, mesh.colors},
                                        flipped, emissive);
}

std::unique_ptr<Rectangle> make(const RectangleDescription& rectangle, bool flipped, bool) {
  const Transform& m = rectangle.to_world;
  const Vec3f edge_u = m.vector({2, 0, 0}), edge_v = m.vector({0, 2, 0});
  // The front side is that of the transformed normal, which a mirroring transform keeps on its side.
  const bool against = dot(cross(edge_u, edge_v), m.normal({0, 0, 1})) < 0;
  return std::make_unique<Rectangle>(m.point({-1, -1, 0}), edge_u, edge_v, against != flipped);
}

std::unique_ptr<Disk> make(const DiskDescription& disk, bool flipped, bool) {
  const Transform& m = disk.to_world;
  const Vec3f tangent = m.vector({1, 0, 0});
  const Vec3f normal = normalize(m.normal({0, 0, 1})) * (flipped ? -1.0f : 1.0f);
  const bool clockwise = dot(cross(tangent, m.vector({0, 1, 0})), normal) < 0;
  return std::make_unique<Disk>(m.point({}), normal, normalize(tangent), length(tangent), clockwise);
}

std::unique_ptr<Sphere> make(const SphereDescription& sphere, bool flipped, bool) {
  return std::make_unique<Sphere>(sphere.center, sphere.radius, flipped, sphere.axes);
}

}  // namespace

const SharedMeshes::Entry& SharedMeshes::of(const std::shared_ptr<const MeshDescription>& description, bool flipped) {
  Entry& entry = meshes_[flipped][description.get()];
  if (entry.mesh == nullptr) {
    entry.mesh = make(*description, flipped, false);
    entry.bounds = entry.mesh->bounds();
  }
  return entry;
}

std::unique_ptr<Shape> add_shape(const ShapeDescription& description, bool emissive, SharedMeshes& shared,
                                 RayAccelerator& accelerator) {
  if (const auto* instance = std::get_if<InstanceDescription>(&description.geometry)) {
    if (emissive) throw SceneError(description.name, "an instance emits light, expected a mesh of its own for each light");
    const SharedMeshes::Entry& entry = shared.of(instance->mesh, description.flip_normals);
    if (!(entry.mesh->area() > 0)) throw SceneError(description.name, "the shape has no area");
    auto shape = std::make_unique<MeshInstance>(*entry.mesh, entry.bounds, instance->to_world);
    accelerator.add(*shape);
    return shape;
  }
  return std::visit(
      [&](const auto& geometry) -> std::unique_ptr<Shape> {
        if constexpr (std::is_same_v<std::decay_t<decltype(geometry)>, InstanceDescription>) {
          return nullptr;  // made above
        } else {
          auto shape = make(geometry, description.flip_normals, emissive);
          if (!(shape->area() > 0)) throw SceneError(description.name, "the shape has no area");
          accelerator.add(*shape);
          return shape;
        }
      },
      description.geometry);
}

}  // namespace fluxfarm
