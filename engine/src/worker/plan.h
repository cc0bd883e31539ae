// The plan: which parts of the engine a scene switches on and which were left out, with the reason.
#pragma once

#include <string>

#include "integrators/integrator.h"
#include "scene/scene.h"

namespace fluxfarm {

// A JSON object {"integrator", "census": {...}, "parts": [{"part", "on", "reason"}]}.
std::string plan_json(const Scene& scene, const Integrator& integrator);

}  // namespace fluxfarm
