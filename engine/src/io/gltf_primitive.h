// One primitive of a glTF mesh as triangles in its own space.
#pragma once

#include <optional>

#include "io/gltf_file.h"
#include "io/mesh_checks.h"

namespace fluxfarm {

// What reading a primitive may take from the whole file's share, and says once.
struct GltfMeshBudget {
  std::uint64_t elements = 0;  // vertices and indices read so far, at most kMaxAccessorElements
};

struct GltfPrimitive {
  RawMesh mesh;
  bool face_normals = false;  // the file has no normals: flat, as glTF wants it
  bool has_alpha = false;     // some colour of a vertex is not opaque
};

// Triangles, strips and fans. `uv_set`: which TEXCOORD becomes the texture coordinates, if the mesh has it. Nothing, with a line in
// `warnings`, for points and lines and for a primitive without positions. Throws SceneError.
std::optional<GltfPrimitive> read_gltf_primitive(GltfFile& file, const GltfObject& primitive, int uv_set, GltfMeshBudget& budget,
                                                 std::vector<std::string>& warnings);

}  // namespace fluxfarm
