// KHR_lights_punctual: point, spot and directional lights.
//
// Their numbers are photometric in glTF: candela and lux. They are taken as W/sr and W/m^2 as they stand, as emissive factors are
// taken as W m^-2 sr^-1, so lights and emissive surfaces of one file keep their proportion.
#pragma once

#include "io/gltf_nodes.h"
#include "scene/description.h"

namespace fluxfarm {

// The light that a node places; it shines along the node's -z. Throws SceneError.
EmitterDescription read_gltf_light(const GltfFile& file, const GltfPlaced& placed);

}  // namespace fluxfarm
