// What photons around a place tell about the light there: the sum of their flux over the area that they lie in.
//
// [Jensen96] H. W. Jensen, "Global Illumination using Photon Maps", EGWR 1996.
//
// Biased: the light of the whole patch is taken for that of its middle; the radius controls it (density_kernel.h). Over flat and
// evenly lit surfaces it is right in the mean, for fixed radii and for the nearest photons: the photon that sets the radius lies on
// its rim and is not counted, which is the rule of k - 1, and where max_radius comes first it is a fixed radius. (Each photon that
// is counted sees a radius that the others set, over whose disk its weight has mean one.) The disk reaches over edges of surfaces:
// there the estimate is too small by the part outside, which disk_in_sight.h tells.
#pragma once

#include <cmath>
#include <cstdint>

#include "integrators/photon/nearest_photons.h"
#include "integrators/photon/photon_map.h"
#include "integrators/photon/surface_patch.h"

namespace fluxfarm {

// Irradiance by photons.
struct DensityEstimate {
  Rgb value;                  // W m^-2
  std::uint32_t photons = 0;  // that were counted
  float radius = 0;           // m
};

// By all photons within `radius` (m).
template <typename Kernel>
DensityEstimate estimate_within(const PhotonMap& map, const SurfacePatch& patch, float radius, const Kernel& kernel) {
  DensityEstimate estimate{.value = {}, .photons = 0, .radius = radius};
  const float per_radius_squared = 1 / (radius * radius);
  map.for_each_within(patch.position(), radius, [&](Vec3f d, const PhotonLight& light) {
    if (!patch.accepts(d, light)) return;
    estimate.value += light.flux() * kernel.weight(length_squared(d) * per_radius_squared);
    ++estimate.photons;
  });
  estimate.value *= kInvPi * per_radius_squared;
  return estimate;
}

// Calls visit(photon, t), t = squared distance over squared radius of the disk, for each photon of the map that counts among those
// for which accept(d, light), d leading there from `position`: the nearest `count` (at least 2), of which the farthest sets the
// radius and is not visited, or all within `max_radius` (m) if those are fewer. Returns the squared radius, m^2; 0 if there is no
// disk. `nearest` is workspace: keep it from one call to the next.
template <typename Accept, typename Visit>
float for_each_nearest(const PhotonMap& map, Vec3f position, std::size_t count, float max_radius, const Accept& accept,
                       NearestPhotons& nearest, const Visit& visit) {
  float radius_squared = max_radius * max_radius;
  nearest.start(count, radius_squared);
  map.find_nearest(position, accept, nearest);
  nearest.finish();
  if (nearest.size() == count) {
    const std::size_t farthest = nearest.farthest();
    radius_squared = nearest.distances_squared()[farthest];
    nearest.remove(farthest);
  }
  if (!(radius_squared > 0)) return 0;
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    visit(nearest.photons()[i], nearest.distances_squared()[i] / radius_squared);
  }
  return radius_squared;
}

// By the nearest `count` photons, as for_each_nearest().
template <typename Kernel>
DensityEstimate estimate_by_nearest(const PhotonMap& map, const SurfacePatch& patch, std::size_t count, float max_radius,
                                    const Kernel& kernel, NearestPhotons& nearest) {
  DensityEstimate estimate;
  const float radius_squared = for_each_nearest(
      map, patch.position(), count, max_radius, [&](Vec3f d, const PhotonLight& light) { return patch.accepts(d, light); }, nearest,
      [&](std::uint32_t photon, float t) {
        estimate.value += map.light(photon).flux() * kernel.weight(t);
        ++estimate.photons;
      });
  if (!(radius_squared > 0)) return {};
  estimate.value *= kInvPi / radius_squared;
  estimate.radius = std::sqrt(radius_squared);
  return estimate;
}

}  // namespace fluxfarm
