// What a material, with all that it holds, needs to know of the places where it is asked. A scene computes no more than that.
#pragma once

#include <cstddef>

#include "scene/description.h"

namespace fluxfarm {

struct MaterialNeeds {
  bool anisotropic = false;     // two roughnesses somewhere
  bool normal_maps = false;     // or bump maps
  bool tangents = false;        // for either
  bool uvs = false;             // some texture lies over uv
  bool uv_derivatives = false;  // for bump maps, and normal maps that ask for v
  bool vertex_colors = false;
  bool masks = false;        // light goes straight through, in part or everywhere
  bool delta_lobes = false;  // some light is scattered into single directions
  bool glossy = false;       // or less evenly than by a diffuse surface
};

// `material`: index into the description's materials, which do not contain themselves.
MaterialNeeds material_needs(const SceneDescription& scene, std::size_t material);

}  // namespace fluxfarm
