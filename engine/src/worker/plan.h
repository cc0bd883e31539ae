// The plan: which parts of the engine a scene switches on and which were left out, with the reason.
#pragma once

#include <string>

#include "integrators/integrator.h"
#include "integrators/plan/method_choice.h"
#include "scene/scene.h"

namespace fluxfarm {

// A JSON object {"integrator", "census": {...}, "parts": [{"part", "on", "reason"}]} and, where the method was chosen by a pilot,
// "choice": {"reason", "goal", "seconds", "expected_seconds", "methods": [{"method", "tried", "reason", "error", "samples",
// "seconds", "work"}]}: what each method is foretold to take, in seconds here and in rays of path tracing, by which it was chosen.
std::string plan_json(const Scene& scene, const Integrator& integrator, const MethodChoice* choice = nullptr);

}  // namespace fluxfarm
