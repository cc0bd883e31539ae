// Reads Mitsuba 3's XML into a plugin tree, with <default>, $name and <include>, and the 0.6 spellings of older files.
#pragma once

#include <map>
#include <string>

#include "io/bundle.h"
#include "io/plugin_tree.h"

namespace fluxfarm {

// Values for $name given from outside; they win over <default>.
using SceneOverrides = std::map<std::string, std::string>;

// Throws SceneError with file and line. A name in `overrides` that the scene never uses is an error, too.
PluginNode read_mitsuba_xml(const Bundle& bundle, const SceneOverrides& overrides);

}  // namespace fluxfarm
