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
#include "scene/scene.h"

namespace fluxfarm {

class CausticPhotons {
 public:
  CausticPhotons(const Scene& scene, const CausticMaps& maps)
      : scene_(scene), maps_(maps), pixel_angle_(scene.camera().pixel_angle()) {}

  struct State {
    PhotonShare share;
    std::uint32_t sample = 0;
    float length = 0;  // of the path so far, m
  };
  State start(const CameraSample& sample) const { return {.share = {}, .sample = sample.index}; }
  bool ended(const State&) const { return false; }
  // At a surface, `distance` (m) from where the ray began.
  void arrive(State& state, float distance) const {
    state.share.travel(distance);
    state.length += distance;
  }
  void scatter(State& state, const BsdfSample& sample) const {
    if (!sample.passes) state.share.scatter(lobe_value(sample));
  }

  // Adds the caustic light that continuous lobes of the surface scatter to the path. `room`: the path may have so many surfaces
  // from this one on, and less than that.
  void gather(const State& state, const PathVertex& vertex, int room, const Rgb& throughput, const LightHistory& history,
              SampleResult& result);

  float left_of_map(const State& state, Vec3f direction) const {
    const EnvmapEmitter* map = scene_.environment_map().emitter;
    if (map == nullptr) return 1;
    return state.share.left_of_found({0, 1 / map->from(direction).pdf_solid_angle});
  }
  float left_of_found(const State& state, const AreaEmitter& emitter, const SurfacePoint& point, Vec3f direction) const {
    return state.share.left_of_found(emitter.apparent_size(point, direction));
  }
  float left_of_asked(const State& state, const Rgb& f, const Emitter& emitter, const EmitterSample& light) const {
    return state.share.left_of_asked(max_component(f), solid_angle_of(emitter, light));
  }

 private:
  // Photons of an estimate at most: where they lie close their disks are small.
  static constexpr std::size_t kNearest = 16;

  const Scene& scene_;
  const CausticMaps& maps_;
  float pixel_angle_;
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

}  // namespace fluxfarm
