// fluxfarm-engine bench photons: shooting photons, building their map and asking it.
#pragma once

#include <nlohmann/json.hpp>

#include "scene/scene.h"

namespace fluxfarm {

// Medians of a few rounds on so many threads. `nanoflann_...` are there if nanoflann was there when this was built.
nlohmann::json bench_photons(const Scene& scene, int threads);

}  // namespace fluxfarm
