// What photons around a place tell about the light there: the sum of their flux over the area that they lie in.
//
// [Jensen96] H. W. Jensen, "Global Illumination using Photon Maps", EGWR 1996.
//
// Biased: the light of the whole patch is taken for that of its middle; the radius controls it (density_kernel.h). Over flat and
// evenly lit surfaces it is right in the mean, for fixed radii and for the nearest photons: the photon that sets the radius lies on
// its rim and is not counted, which is the rule of k - 1, and where max_radius comes first it is a fixed radius. (Each photon that
// is counted sees a radius that the others set, over whose disk its weight has mean one.) The disk reaches over edges of surfaces:
// there the estimate is too small by the part outside.
#pragma once

#include <cmath>
#include <cstdint>

#include "integrators/path/path_vertex.h"
#include "integrators/photon/nearest_photons.h"
#include "integrators/photon/photon_map.h"
#include "integrators/photon/surface_patch.h"

namespace fluxfarm {

struct DensityEstimate {
  Rgb value;                  // of irradiance W m^-2, of radiance W m^-2 sr^-1
  std::uint32_t photons = 0;  // that were counted
  float radius = 0;           // m
};

// What the flux of a photon counts for: irradiance.
struct AsIrradiance {
  Rgb operator()(const PhotonLight&) const { return Rgb{1}; }
};

// Or radiance towards vertex.wo. Flux over area holds the cosine to the geometric normal, scattering the one to the shading normal.
class AsRadiance {
 public:
  explicit AsRadiance(const PathVertex& vertex) : vertex_(vertex) {}

  Rgb operator()(const PhotonLight& light) const {
    const Vec3f world = normalize(light.wi()), wi = vertex_.frame.to_local(world);
    const float arriving = std::fabs(dot(world, vertex_.point.geometric_normal));
    if (!(arriving > 0)) return {};
    return vertex_.bsdf->value(vertex_.wo, wi).f * (std::fabs(wi.z) / arriving);
  }

 private:
  const PathVertex& vertex_;
};

// By all photons within `radius` (m).
template <typename Kernel, typename Response>
DensityEstimate estimate_within(const PhotonMap& map, const SurfacePatch& patch, float radius, const Kernel& kernel,
                                const Response& response) {
  DensityEstimate estimate{.value = {}, .photons = 0, .radius = radius};
  const float per_radius_squared = 1 / (radius * radius);
  map.for_each_within(patch.position(), radius, [&](Vec3f d, const PhotonLight& light) {
    if (!patch.accepts(d, light)) return;
    estimate.value += light.flux() * response(light) * kernel.weight(length_squared(d) * per_radius_squared);
    ++estimate.photons;
  });
  estimate.value *= kInvPi * per_radius_squared;
  return estimate;
}

// By the nearest `count` photons (at least 2), of which the farthest sets the radius, or by all within `max_radius` (m) if those
// are fewer. `nearest` is workspace: keep it from one call to the next.
template <typename Kernel, typename Response>
DensityEstimate estimate_by_nearest(const PhotonMap& map, const SurfacePatch& patch, std::size_t count, float max_radius,
                                    const Kernel& kernel, const Response& response, NearestPhotons& nearest) {
  nearest.start(count, max_radius * max_radius);
  map.find_nearest(
      patch.position(), [&](Vec3f d, const PhotonLight& light) { return patch.accepts(d, light); }, nearest);
  nearest.finish();
  float radius_squared = max_radius * max_radius;
  if (nearest.size() == count) {
    const std::size_t farthest = nearest.farthest();
    radius_squared = nearest.distances_squared()[farthest];
    nearest.remove(farthest);
  }
  DensityEstimate estimate{.value = {}, .photons = static_cast<std::uint32_t>(nearest.size()), .radius = std::sqrt(radius_squared)};
  if (!(radius_squared > 0)) return estimate;
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    const PhotonLight& light = map.light(nearest.photons()[i]);
    estimate.value += light.flux() * response(light) * kernel.weight(nearest.distances_squared()[i] / radius_squared);
  }
  estimate.value *= kInvPi / radius_squared;
  return estimate;
}

}  // namespace fluxfarm
