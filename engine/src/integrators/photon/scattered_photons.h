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

  // What one photon brings, W sr^-1: weight times flux times f in the disk, and in that of half the area.
  struct Part {
    Rgb wide, narrow;
    bool smooth = false;  // only mirrors and smooth refractions scattered the light before
  };

  // `t`: squared distance over squared radius of the disk. What the surface would scatter sharply is left out: that light is for
  // the next surface on the path's way to the eye.
  Part part(const PhotonLight& light, float t) const {
    const Vec3f world = normalize(light.wi()), wi = vertex_.frame.to_local(world);
    const float arriving = std::fabs(dot(world, vertex_.point.geometric_normal));
    if (!(arriving > 0)) return {};
    const Rgb f = vertex_.bsdf->value(vertex_.wo, wi).f;
    const float share = (1 - sharpness(1 / max_component(f))) * std::fabs(wi.z) / arriving;
    const Rgb scattered = light.flux() * f * share;
    constexpr EpanechnikovKernel kKernel;
    return {scattered * kKernel.weight(t), t < 0.5f ? scattered * (2 * kKernel.weight(2 * t)) : Rgb{},
            light.kind() == PhotonKind::kCaustic};
  }
  void add(const Part& part) {
    (part.smooth ? smooth_ : rough_) += part.wide;
    narrower_ += part.narrow;
  }
  void remove(const Part& part) { add({part.wide * -1, part.narrow * -1, part.smooth}); }
  void scale(float wide, float narrow) {
    smooth_ *= wide;
    rough_ *= wide;
    narrower_ *= narrow;
  }

  // Adds the nearest `count` photons or all within `max_radius` (m), as for_each_nearest(), of those that `patch` accepts and that
  // met fewer than `room` surfaces, and calls note(photon, part) for each. Returns the squared radius, m^2.
  template <typename Note>
  float add_nearest(const PhotonMap& map, const SurfacePatch& patch, std::size_t count, float max_radius, int room,
                    NearestPhotons& nearest, const Note& note) {
    return for_each_nearest(
        map, patch.position(), count, max_radius,
        [&](Vec3f d, const PhotonLight& light) { return light.surfaces() < room && patch.accepts(d, light); }, nearest,
        [&](std::uint32_t photon, float t) {
          const Part added = part(map.light(photon), t);
          add(added);
          note(photon, added);
        });
  }
  float add_nearest(const PhotonMap& map, const SurfacePatch& patch, std::size_t count, float max_radius, int room,
                    NearestPhotons& nearest) {
    return add_nearest(map, patch, count, max_radius, room, nearest, [](std::uint32_t, const Part&) {});
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
