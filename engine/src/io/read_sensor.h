// Reads sensor, film, reconstruction filter, sampler and integrator.
#pragma once

#include "io/plugin_tree.h"
#include "io/read_medium.h"
#include "scene/description.h"

namespace fluxfarm {

// Camera with the medium around it, film and samples per pixel go into `scene`. Throws SceneError.
void read_sensor(const PluginNode& sensor, MediumReader& media, SceneDescription& scene);

MethodDescription read_integrator(const PluginNode& integrator);

}  // namespace fluxfarm
