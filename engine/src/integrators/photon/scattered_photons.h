// What a surface scatters to a path of the light of photons in a disk around a place, and how much of that is blur.
#pragma once

#include <cmath>

#include "integrators/integrator.h"
#include "integrators/light_history.h"
#include "integrators/path/path_vertex.h"
#include "integrators/photon/density_estimate.h"
#include "integrators/photon/density_kernel.h"
#include "integrators/photon/nearest_photons.h"
#include "integrators/photon/photon.h"
#include "integrators/photon/photon_map.h"
#include "integrators/photon/sharpness.h"
#include "integrators/photon/surface_patch.h"

namespace fluxfarm {

class ScatteredPhotons {
 public:
  explicit ScatteredPhotons(const PathVertex& vertex) : vertex_(vertex) {}

  // `t`: squared distance over squared radius of the disk. What the surface would scatter sharply it leaves out: that light is for
  // the next surface on the path's way to the eye.
  void add(const PhotonLight& light, float t) {
    const Vec3f world = normalize(light.wi()), wi = vertex_.frame.to_local(world);
    const float arriving = std::fabs(dot(world, vertex_.point.geometric_normal));
    if (!(arriving > 0)) return;
    const Rgb f = vertex_.bsdf->value(vertex_.wo, wi).f;
    const float part = (1 - sharpness(1 / max_component(f))) * std::fabs(wi.z) / arriving;
    const Rgb scattered = light.flux() * f * part;
    constexpr EpanechnikovKernel kKernel;
    (light.kind() == PhotonKind::kCaustic ? smooth_ : rough_) += scattered * kKernel.weight(t);
    if (t < 0.5f) narrower_ += scattered * (2 * kKernel.weight(2 * t));
  }

  // Adds the nearest `count` photons or all within `max_radius` (m), as for_each_nearest(), of those that `patch` accepts and that
  // met fewer than `room` surfaces. Returns the squared radius, m^2.
  float add_nearest(const PhotonMap& map, const SurfacePatch& patch, std::size_t count, float max_radius, int room,
                    NearestPhotons& nearest) {
    return for_each_nearest(
        map, patch.position(), count, max_radius,
        [&](Vec3f d, const PhotonLight& light) { return light.surfaces() < room && patch.accepts(d, light); }, nearest,
        [&](const PhotonLight& light, float t) { add(light, t); });
  }

  // Adds it to what a path brings back that is weighted with `throughput`. `radius_squared` (m^2): of the disk; 0 adds nothing.
  void add_to(SampleResult& result, const Rgb& throughput, float radius_squared, const LightHistory& history) const {
    if (!(radius_squared > 0)) return;
    const Rgb scale = throughput * (kInvPi / radius_squared);
    result.add(scale * smooth_, history.layer_by_caustic());
    result.add(scale * rough_, history.layer_by_indirect());
    result.bias += scale * (smooth_ + rough_ - narrower_) * kBiasPerDifference;
  }

 private:
  const PathVertex& vertex_;
  // Sums of weight times flux times f, W sr^-1: of light that only mirrors and smooth refractions scattered before, of other light,
  // and of all of it in the disk of half the area.
  Rgb smooth_, rough_, narrower_;
};

}  // namespace fluxfarm
