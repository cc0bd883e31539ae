// Photons on behalf of a group of paths (path/path_group.h): what each path sees of the caustic map, and what it leaves to it.
#pragma once

#include <algorithm>
#include <cmath>

#include "integrators/integrator.h"
#include "integrators/light_history.h"
#include "integrators/path/path_vertex.h"
#include "integrators/photon/caustic_maps.h"
#include "integrators/photon/nearest_photons.h"
#include "integrators/photon/scattered_photons.h"
#include "integrators/photon/sharpness.h"
#include "integrators/photon/surface_patch.h"
#include "integrators/photon/volume_estimate.h"
#include "scene/scene.h"

namespace fluxfarm {

class CausticPhotons {
 public:
  CausticPhotons(const Scene& scene, const CausticMaps& maps)
      : scene_(scene), maps_(maps), pixel_angle_(scene.camera().pixel_angle()), least_distance_(kLeastDistance * scene.radius()) {}

  static constexpr bool kInMedia = true;
  struct State {
    PhotonShare share;
    std::uint32_t sample = 0;
    float length = 0;  // of the path so far, m
  };
  State start(const CameraSample& sample) const { return {.share = {}, .sample = sample.index}; }
  bool ended(const State&) const { return false; }
  // At a surface or a collision, `distance` (m) from where the ray began.
  void arrive(State& state, float distance) const {
    state.share.travel(distance);
    state.length += distance;
  }
  void scatter(State& state, const BsdfSample& sample) const {
    if (!sample.passes) state.share.scatter(lobe_value(sample));
  }

  // In a medium whose phase function has that value for the light that comes from where the path goes, sr^-1.
  void scatter_in_medium(State& state, float value) const { state.share.scatter(value); }

  // Adds the caustic light that continuous lobes of the surface scatter to the path. `room`: the path may have so many surfaces
  // from this one on, and less than that.
  void gather(const State& state, const PathVertex& vertex, int room, const Rgb& throughput, const LightHistory& history,
              SampleResult& result);

  // The same for what `medium` scatters along a ray of the path, up to its end.
  void gather_along(const State& state, const Ray& ray, const HomogeneousMedium& medium, int room, const Rgb& throughput,
                    const LightHistory& history, SampleResult& result) const;

  float left_of_map(const State& state, Vec3f direction) const {
    const EnvmapEmitter* map = scene_.environment_map().emitter;
    if (map == nullptr) return 1;
    return state.share.left_of_found({0, 1 / map->from(direction).pdf_solid_angle});
  }
  float left_of_constant(const State&) const { return 1; }
  float left_of_found(const State& state, const AreaEmitter& emitter, const SurfacePoint& point, Vec3f direction) const {
    return state.share.left_of_found(emitter.apparent_size(point, direction));
  }
  float left_of_asked(const State& state, const Rgb& f, const Emitter& emitter, const EmitterSample& light) const {
    return state.share.left_of_asked(max_component(f), solid_angle_of(emitter, light));
  }

 private:
  // Photons of an estimate at a surface at most: where they lie close their disks are small.
  static constexpr std::size_t kNearest = 16;
  // Beams are no narrower than pixels see them from so far away, over the radius of the scene (a choice): one photon right before
  // the lens would be as bright as all others together.
  static constexpr float kLeastDistance = 0.05f;

  const Scene& scene_;
  const CausticMaps& maps_;
  float pixel_angle_;
  float least_distance_;  // m
  NearestPhotons nearest_;
};

inline void CausticPhotons::gather(const State& state, const PathVertex& vertex, int room, const Rgb& throughput,
                                   const LightHistory& history, SampleResult& result) {
  const PhotonMap& map = maps_.map(state.sample);
  const float max_radius = maps_.radius() * pixel_angle_ * state.length;
  if (map.size() == 0 || !(max_radius > 0)) return;
  ScatteredPhotons scattered(vertex);
  const float radius_squared = scattered.add_nearest(map, SurfacePatch(vertex, max_radius), kNearest, max_radius, room, nearest_);
  scattered.add_to(result, throughput, radius_squared, history);
}

inline void CausticPhotons::gather_along(const State& state, const Ray& ray, const HomogeneousMedium& medium, int room,
                                         const Rgb& throughput, const LightHistory& history, SampleResult& result) const {
  const PhotonMap& map = maps_.in_media(state.sample);
  if (map.size() == 0) return;
  const float spread = maps_.radius() * pixel_angle_;
  const Beam beam{ray.origin, ray.direction, ray.t_max, spread * (state.length + least_distance_), spread};
  const BeamRadiance found = scattered_along(map, beam, medium, room);
  result.add(throughput * found.value, history.layer_by_medium());
  result.bias += throughput * found.bias;
}

}  // namespace fluxfarm
