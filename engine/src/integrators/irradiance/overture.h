// Makes the cache of a picture before its samples are taken: records where the camera sees diffuse surfaces, straight or by way of
// mirrors and glass, until those that there are cover what it sees.
//
// From coarse to fine over the pixels: at each step the cache as it is decides which pixels lack a record, these are made side by
// side, and put in by the order of their pixels. So neither threads nor tiles change a bit, and no tile adds a record.
//
// Points of surfaces that pixels and records see tell each record what stands near it that its own rays missed (clearance.h): it
// shrinks, and the next step finds what it no longer covers.
#pragma once

#include <atomic>
#include <cstdint>

#include "integrators/integrator.h"
#include "integrators/irradiance/cache_quality.h"
#include "integrators/irradiance/irradiance_cache.h"
#include "integrators/photon/caustic_maps.h"
#include "scene/scene.h"

namespace fluxfarm {

struct Overture {
  IrradianceCache cache;
  std::uint64_t rays = 0;
};

// `caustics`, `known`: as for make_hemisphere_sampler(); `known` is the cache of a larger tolerance. Throws CancelledError soon
// after `cancelled` becomes true.
Overture make_overture(const Scene& scene, const CausticMaps* caustics, const IrradianceCache* known, std::uint64_t seed,
                       const CacheQuality& quality, int threads, const std::atomic<bool>& cancelled);

}  // namespace fluxfarm
