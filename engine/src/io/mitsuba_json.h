// Reads the JSON form of the plugin tree: Mitsuba's dict, an object per plugin with its "type" and its parameters.
#pragma once

#include "io/bundle.h"
#include "io/plugin_tree.h"

namespace fluxfarm {

// Throws SceneError with the file and the path of the member, or with line and column if the text is no JSON.
PluginNode read_mitsuba_json(const Bundle& bundle);

}  // namespace fluxfarm
