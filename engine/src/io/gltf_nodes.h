// The node tree of a glTF scene, walked to what it places in the world: meshes, lights and cameras.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/gltf_file.h"
#include "math/transform.h"

namespace fluxfarm {

// An element of the document (meshes, lights, cameras) at a place in the world.
struct GltfPlaced {
  std::size_t index = 0;
  Transform to_world;
  std::string name;  // of the node, for messages
};

struct GltfNodes {
  std::vector<GltfPlaced> meshes, lights, cameras;  // meshes: instances of EXT_mesh_gpu_instancing one by one
};

// Walks the file's scene (`scene`, or the first; without any, all nodes that are no children). Throws SceneError for a node that is
// reached twice (a cycle, or two parents), nesting deeper than kMaxNodeDepth, more than kMaxPlacedMeshes meshes, and transforms
// that are not finite. Lines in `warnings` say what is not read: skins.
GltfNodes read_gltf_nodes(GltfFile& file, const Transform& to_world, std::vector<std::string>& warnings);

}  // namespace fluxfarm
