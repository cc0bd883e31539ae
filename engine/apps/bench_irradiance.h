// fluxfarm-engine bench irradiance: how fast an irradiance cache is made and asked.
#pragma once

#include <nlohmann/json.hpp>

#include "scene/scene.h"

namespace fluxfarm {

// Makes a cache of at least ten thousand records for what the camera sees, or the largest that the scene asks for, and asks it for
// irradiance at what pixels see. Throws Error if they see no diffuse surface.
nlohmann::json bench_irradiance(const Scene& scene, int threads);

}  // namespace fluxfarm
