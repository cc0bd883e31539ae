// From the triangles of a file to a mesh in world space: transform, checks, missing normals, orientation.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "math/transform.h"
#include "scene/description.h"

namespace fluxfarm {

// What a mesh file holds, in object space.
struct RawMesh {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;          // one per vertex or none at all; 0 0 0 where the file gives none; any length
  std::vector<Vec2f> uvs;              // one per vertex or none
  std::vector<Rgb> colors;             // one per vertex or none; linear
  std::vector<std::uint32_t> indices;  // three per triangle
  std::string name;                    // the file as messages show it
};

struct MeshOptions {
  Transform to_world;
  bool face_normals = false;     // drop all vertex normals
  bool flip_tex_coords = false;  // v becomes 1 - v
};

// The mesh in world space. Triangles of no area are left out, with a line in `warnings`. Vertex normals that the file lacks are
// computed, unless face_normals. Where there are vertex normals they decide which side is the front, as they do in Mitsuba:
// the corners of a triangle that its normals contradict are put in the other order.
// Throws SceneError for an index out of range, a vertex that is not finite, and a mesh without any triangle of positive area.
MeshDescription finish_mesh(RawMesh raw, const MeshOptions& options, std::vector<std::string>& warnings);

}  // namespace fluxfarm
