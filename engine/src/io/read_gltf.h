// glTF 2.0, .glb or .gltf: a whole scene, or what a shape node of a Mitsuba scene brings into it. README.md lists what is read.
#pragma once

#include "io/bundle.h"
#include "io/plugin_tree.h"
#include "scene/description.h"

namespace fluxfarm {

// The bundle's entry as a whole scene. What it lacks is supplied, with a warning each: a camera that frames everything, a constant
// white environment of radiance 1 where nothing shines. Throws SceneError.
SceneDescription read_gltf_scene(const Bundle& bundle);

// Adds the shapes and lights of the file that the shape node "gltf" names; its cameras are left aside. Throws SceneError.
void read_gltf_node(const PluginNode& node, const Bundle& bundle, SceneDescription& scene);

}  // namespace fluxfarm
