// Reads sensor, film, reconstruction filter, sampler and integrator.
#pragma once

#include "io/plugin_tree.h"
#include "scene/description.h"

namespace fluxfarm {

// Camera, film and samples per pixel of a `perspective` sensor go into `scene`. Throws SceneError.
void read_sensor(const PluginNode& sensor, SceneDescription& scene);

MethodDescription read_integrator(const PluginNode& integrator);

}  // namespace fluxfarm
