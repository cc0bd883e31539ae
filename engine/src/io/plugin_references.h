// Finds the plugins that references mean, before or after the reference in the file.
#pragma once

#include <string>
#include <unordered_map>

#include "io/plugin_tree.h"

namespace fluxfarm {

using PluginsById = std::unordered_map<std::string, const PluginNode*>;

// Every plugin of the tree that has an id. Throws SceneError if two share one.
PluginsById plugins_by_id(const PluginNode& scene);

// The plugin of that kind that a reference means. Throws SceneError if the id is unknown or belongs to something else.
const PluginNode& referenced(const PluginNode& reference, PluginKind kind, const PluginsById& plugins);

}  // namespace fluxfarm
