// Reads the bsdf `principled`.
#pragma once

#include "io/properties.h"
#include "io/read_texture.h"
#include "materials/material_description.h"

namespace fluxfarm {

// Asks for all parameters; the caller finishes. Throws SceneError.
PrincipledDescription read_principled(Properties& properties, TextureReader& textures);

}  // namespace fluxfarm
