// The door of this room: a scene file and the files beside it become a SceneDescription.
#pragma once

#include <filesystem>

#include "io/mitsuba_xml.h"
#include "scene/description.h"

namespace fluxfarm {

// Reads `entry`, a path relative to `folder`: Mitsuba XML (.xml), the same plugin tree as JSON (.json), or glTF 2.0
// (.glb, .gltf). `overrides` gives
// values for $name that win over <default>; only XML has them. Nothing outside `folder` is opened.
//
// The result is complete and checked; what deserves a word but is no error (no light, triangles without area, a second sensor)
// is in its `warnings`. Throws SceneError whose text names file and place, the value, and what would be right; ResourceError if
// the machine cannot read a file. README.md lists what is accepted.
SceneDescription read_scene(const std::filesystem::path& folder, const std::filesystem::path& entry,
                            const SceneOverrides& overrides = {});

}  // namespace fluxfarm
