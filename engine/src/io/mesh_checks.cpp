#include "io/mesh_checks.h"

#include <array>
#include <cmath>

#include "io/text.h"
#include "io/vertex_normals.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

std::string coordinates(Vec3f p) { return "(" + number_text(p.x) + ", " + number_text(p.y) + ", " + number_text(p.z) + ")"; }

void check_indices(const RawMesh& mesh) {
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    if (mesh.indices[i] >= mesh.positions.size()) {
      throw SceneError(mesh.name, "triangle " + std::to_string(i / 3) + " refers to vertex " + std::to_string(mesh.indices[i]) +
                                      ", expected an index below " + std::to_string(mesh.positions.size()));
    }
  }
}

void transform_positions(RawMesh& mesh, const Transform& to_world) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3f world = to_world.point(mesh.positions[i]);
    if (!is_finite(world)) {
      throw SceneError(mesh.name, "vertex " + std::to_string(i) + " is " + coordinates(mesh.positions[i]) + ", in the world " +
                                      coordinates(world) + ", expected finite numbers");
    }
    mesh.positions[i] = world;
  }
}

// To unit length in world space; 0 0 0 stays.
void transform_normals(RawMesh& mesh, const Transform& to_world) {
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    Vec3f& normal = mesh.normals[i];
    if (normal == Vec3f{}) continue;
    const Vec3f world = to_world.normal(normal);
    const Vec3f unit = world / std::max({std::abs(world.x), std::abs(world.y), std::abs(world.z)});  // no overflow in length
    if (!is_finite(normal) || !is_finite(unit)) {
      throw SceneError(mesh.name, "the normal of vertex " + std::to_string(i) + " is " + coordinates(normal) + ", in the world " +
                                      coordinates(world) + ", expected a finite direction");
    }
    normal = normalize(unit);
  }
}

void remove_degenerate_triangles(RawMesh& mesh, std::vector<std::string>& warnings) {
  const std::size_t before = mesh.indices.size() / 3;
  std::size_t kept = 0;
  for (std::size_t t = 0; t < before; ++t) {
    const std::uint32_t* corner = &mesh.indices[3 * t];
    const auto n = face_normal(mesh.positions[corner[0]], mesh.positions[corner[1]], mesh.positions[corner[2]]);
    if (n == std::array<double, 3>{0, 0, 0}) continue;
    for (std::size_t c = 0; c < 3; ++c) mesh.indices[3 * kept + c] = corner[c];
    ++kept;
  }
  if (kept == 0) {
    throw SceneError(mesh.name, before == 0
                                    ? std::string("has no triangles")
                                    : "all " + std::to_string(before) + " triangles have no area, expected at least one that has");
  }
  mesh.indices.resize(3 * kept);
  if (kept < before) {
    warnings.push_back(mesh.name + ": " + std::to_string(before - kept) + " of " + std::to_string(before) +
                       " triangles have no area and were left out");
  }
}

void orient_to_normals(RawMesh& mesh) {
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    const std::uint32_t a = mesh.indices[t], b = mesh.indices[t + 1], c = mesh.indices[t + 2];
    const auto n = face_normal(mesh.positions[a], mesh.positions[b], mesh.positions[c]);
    const Vec3f shading = mesh.normals[a] + mesh.normals[b] + mesh.normals[c];
    if (n[0] * shading.x + n[1] * shading.y + n[2] * shading.z < 0) std::swap(mesh.indices[t + 1], mesh.indices[t + 2]);
  }
}

void check_uvs(const RawMesh& mesh) {
  for (std::size_t i = 0; i < mesh.uvs.size(); ++i) {
    if (!std::isfinite(mesh.uvs[i].x) || !std::isfinite(mesh.uvs[i].y)) {
      throw SceneError(mesh.name, "the texture coordinates of vertex " + std::to_string(i) + " are " + number_text(mesh.uvs[i].x) +
                                      ", " + number_text(mesh.uvs[i].y) + ", expected finite numbers");
    }
  }
}

}  // namespace

MeshDescription finish_mesh(RawMesh mesh, const MeshOptions& options, std::vector<std::string>& warnings) {
  check_indices(mesh);
  check_uvs(mesh);
  transform_positions(mesh, options.to_world);
  remove_degenerate_triangles(mesh, warnings);
  if (options.face_normals) {
    mesh.normals.clear();
  } else {
    transform_normals(mesh, options.to_world);
    fill_missing_normals(mesh.positions, mesh.indices, mesh.normals);
    orient_to_normals(mesh);
  }
  if (options.flip_tex_coords) {
    for (Vec2f& uv : mesh.uvs) uv.y = 1 - uv.y;
  }
  return {std::move(mesh.positions), std::move(mesh.normals), std::move(mesh.uvs), std::move(mesh.indices), std::move(mesh.colors)};
}

}  // namespace fluxfarm
