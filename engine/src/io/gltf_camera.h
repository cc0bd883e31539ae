// Cameras of a glTF file, or one that frames what the file holds.
#pragma once

#include "io/gltf_nodes.h"
#include "math/bounds.h"
#include "scene/description.h"

namespace fluxfarm {

// Sets camera and film of `scene` from the first perspective camera of the file that a node places; without any, from `bounds` (of
// all shapes, not empty), with a warning. The film has the camera's aspect ratio. Throws SceneError.
void read_gltf_camera(const GltfFile& file, const std::vector<GltfPlaced>& cameras, const Bounds& bounds, SceneDescription& scene);

}  // namespace fluxfarm
