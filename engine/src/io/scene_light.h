// Whether anything in a scene shines.
#pragma once

#include "scene/description.h"

namespace fluxfarm {

// An emissive shape or an emitter that is not black.
bool has_light(const SceneDescription& scene);

}  // namespace fluxfarm
