// Fills the hemisphere of a place with the light that comes there from other surfaces: a path for each stratum.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "accel/ray_queries.h"
#include "integrators/irradiance/hemisphere_grid.h"
#include "integrators/irradiance/irradiance_cache.h"
#include "integrators/photon/caustic_maps.h"
#include "math/frame.h"
#include "scene/scene.h"

namespace fluxfarm {

// A place with all that light needs to get there.
struct GatherPlace {
  Vec3f position;    // world, m
  Frame frame;       // z along the shading normal, on the side that receives
  Vec3f origin;      // where rays from there may start
  int depth = 0;     // surfaces that a path met before it
  int room = 0;      // as ReceivingPlace
  float length = 0;  // of the path from the camera, m
};

class HemisphereSampler {
 public:
  virtual ~HemisphereSampler() = default;

  // Fills `grid` with the light that comes to `place` by way of other surfaces, and from a constant environment: what next-event
  // estimation finds at the place itself is left out. Random numbers are those of `seed` and `place_index`.
  virtual void gather(const GatherPlace& place, std::uint64_t seed, int place_index, HemisphereGrid& grid) = 0;
};

// With `caustics` photons carry their part of the light, as they do for paths from the camera: what they bring to the place itself
// is left out, and what they bring to surfaces that it sees is not. They have a map for each replicate. Null: there are none.
// With `known` paths end where that cache knows the irradiance, as paths from the camera do. Null: they are traced to their ends.
std::unique_ptr<HemisphereSampler> make_hemisphere_sampler(const Scene& scene, const CausticMaps* caustics,
                                                           const IrradianceCache* known, RayQueries& queries);

// The nearest of the points where a few rays from `place` meet surfaces, from the place, in its frame, m; empty if they meet none.
std::optional<Vec3f> nearest_point(const GatherPlace& place, RayQueries& queries);

}  // namespace fluxfarm
