// Photons on behalf of a group of paths (path/path_group.h) that are cut short: all indirect light comes from photon maps.
//
// [Jensen96] H. W. Jensen, "Global Illumination using Photon Maps", EGWR 1996.
// Whether a scattering on the way from the eye is a sharp one is drawn as on the way of photons (sharpness.h). A path goes on
// through sharp ones. At the first that is not, all that comes by more than one surface is read from the maps (direct look); or
// caustics are, and one ray gathers the rest: at the next surface that does not scatter sharply the maps are read (final gather).
#pragma once

#include <algorithm>
#include <cmath>

#include "accel/ray_queries.h"
#include "integrators/integrator.h"
#include "integrators/key_random.h"
#include "integrators/light_history.h"
#include "integrators/path/path_vertex.h"
#include "integrators/photon/density_kernel.h"
#include "integrators/photon/disk_in_sight.h"
#include "integrators/photon/global_maps.h"
#include "integrators/photon/nearest_photons.h"
#include "integrators/photon/one_of_photons.h"
#include "integrators/photon/scattered_photons.h"
#include "integrators/photon/sharpness.h"
#include "integrators/photon/surface_patch.h"
#include "scene/scene.h"

namespace fluxfarm {

class GlobalPhotons {
 public:
  GlobalPhotons(const Scene& scene, const GlobalMaps& maps, std::uint64_t seed, RayQueries& queries)
      : scene_(scene),
        maps_(maps),
        seed_(seed),
        max_radius_(kMaxRadius * scene.radius()),
        gathers_(scene.method().final_gather),
        queries_(queries) {}

  struct State {
    std::uint32_t sample = 0;
    KeyRandom random{0, KeyRandom::kLabel, 0};
    int blurred = 0;              // scatterings so far that were not sharp
    bool from_gathering = false;  // the last one was at a surface that a gather ray had met
    float value = 0;              // of the last one, sr^-1
    float travelled = 0;          // since then, m
  };
  State start(const CameraSample& sample) const {
    const auto pixel = static_cast<std::uint64_t>(sample.y) << 32 | static_cast<std::uint64_t>(sample.x);
    return {.sample = sample.index, .random = KeyRandom(hash_words(seed_, pixel), KeyRandom::kLabel, sample.index)};
  }
  // Whether the path was followed only to see what shines at its end.
  bool ended(const State& state) const { return state.blurred > (gathers_ ? 1 : 0); }
  void arrive(State& state, float distance) const { state.travelled += distance; }
  void scatter(State& state, const BsdfSample& sample) const {
    if (sample.passes) return;
    state.value = lobe_value(sample);
    state.travelled = 0;
    state.from_gathering = state.blurred > 0;
    if (!(state.random.next_1d() < sharpness(1 / state.value))) ++state.blurred;
  }
  void gather(State& state, const PathVertex& vertex, int room, const Rgb& throughput, const LightHistory& history,
              SampleResult& result) {
    estimate(maps_.caustics(state.sample), vertex, room, throughput, history, state.random, result);
    if (gathers_ && state.blurred == 0) return;
    estimate(maps_.indirect(state.sample), vertex, room, throughput, history, state.random, result);
  }

  // Light that comes to a surface of a gather ray and goes on sharply was a caustic where that ray began.
  float left_of_map(const State& state, Vec3f direction) const {
    const EnvmapEmitter* map = scene_.environment_map().emitter;
    return map == nullptr ? 1 : left(state.from_gathering, state.value, 1 / map->from(direction).pdf_solid_angle);
  }
  float left_of_constant(const State&) const { return 1; }
  float left_of_found(const State& state, const AreaEmitter& emitter, const SurfacePoint& point, Vec3f direction) const {
    return left(state.from_gathering, state.value, emitter.apparent_size(point, direction).from(state.travelled));
  }
  float left_of_asked(const State& state, const Rgb& f, const Emitter& emitter, const EmitterSample& light) const {
    return left(state.blurred > 0, max_component(f), solid_angle_of(emitter, light));
  }

 private:
  // Photons of an estimate, and the largest radius over that of the scene (choices).
  static constexpr std::size_t kNearest = 64;
  static constexpr float kMaxRadius = 0.1f;

  static float left(bool gathered, float value, float solid_angle) {
    return gathered ? 1 - sharpness(1 / value + solid_angle) : 1.0f;
  }

  void estimate(const PhotonMap& map, const PathVertex& vertex, int room, const Rgb& throughput, const LightHistory& history,
                KeyRandom& random, SampleResult& result);

  const Scene& scene_;
  const GlobalMaps& maps_;
  std::uint64_t seed_;
  float max_radius_;  // m
  bool gathers_;
  RayQueries& queries_;
  NearestPhotons nearest_;
};

inline void GlobalPhotons::estimate(const PhotonMap& map, const PathVertex& vertex, int room, const Rgb& throughput,
                                    const LightHistory& history, KeyRandom& random, SampleResult& result) {
  ScatteredPhotons scattered(vertex);
  const SurfacePatch patch(vertex, max_radius_);
  OneOfPhotons one(random.next_1d());
  const float radius_squared =
      scattered.add_nearest(map, patch, kNearest, max_radius_, room, nearest_,
                            [&](std::uint32_t photon, const ScatteredPhotons::Part& part) { one.offer(photon, part); });
  if (one.empty()) return;
  const DiskInSight disk(scene_, patch, std::sqrt(radius_squared), queries_);
  const auto [wide, narrow] = disk.inverse_parts(EpanechnikovKernel{}, random);
  if (!disk.sees(map.position(one.photon()), normalize(map.light(one.photon()).normal()))) scattered.remove(one.stands_for());
  scattered.scale(wide, narrow);
  scattered.add_to(result, throughput, radius_squared, history);
}

}  // namespace fluxfarm
