// Reads emitter plugins: area (inside a shape), point, spot, directional, constant and envmap (in the scene).
#pragma once

#include "io/bundle.h"
#include "io/plugin_tree.h"
#include "scene/description.h"

namespace fluxfarm {

// Radiance (W m^-2 sr^-1) of an `area` emitter inside `shape`. Throws SceneError for other emitters.
Rgb read_area_emitter(const PluginNode& emitter, const PluginNode& shape);

// An emitter that stands in the scene by itself; `bundle` finds the image of an envmap. Throws SceneError.
EmitterDescription read_scene_emitter(const PluginNode& emitter, const Bundle& bundle);

}  // namespace fluxfarm
