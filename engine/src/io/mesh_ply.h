// PLY meshes, ascii and binary of both byte orders. Reads vertices and faces; skips other elements and properties.
#pragma once

#include <string>

#include "io/mesh_checks.h"

namespace fluxfarm {

// `file` is the whole file, `name` the file as messages show it. Vertex properties: x y z, nx ny nz, and texture coordinates as
// u v, s t, texture_u texture_v or texture_s texture_t. Faces: vertex_indices or vertex_index; polygons become fans.
// Throws SceneError for a bad header, for counts that the file is too short to hold (before memory is taken for them), and for
// data that ends early.
RawMesh parse_ply(const std::string& file, const std::string& name);

}  // namespace fluxfarm
