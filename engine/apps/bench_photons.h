// fluxfarm-engine bench photons: shooting photons, building their map and asking it.
#pragma once

#include <nlohmann/json.hpp>

#include "scene/scene.h"

namespace fluxfarm {

// Medians of a few rounds on so many threads. What nanoflann does with the same photons is there, or a word that it was left out.
nlohmann::json bench_photons(const Scene& scene, int threads);

}  // namespace fluxfarm
