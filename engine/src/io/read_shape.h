// Reads shape plugins: meshes from files, rectangle, cube, sphere and disk.
#pragma once

#include "io/bundle.h"
#include "io/plugin_tree.h"
#include "io/read_material.h"
#include "io/read_medium.h"
#include "scene/description.h"

namespace fluxfarm {

// The shape with its material, its area emitter and the media on its sides. Opens mesh files through `bundle`. Throws SceneError.
ShapeDescription read_shape(const PluginNode& shape, const Bundle& bundle, MaterialReader& materials, MediumReader& media,
                            std::vector<std::string>& warnings);

}  // namespace fluxfarm
