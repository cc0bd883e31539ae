// Irradiance from a cache on behalf of a group of paths (path/path_group.h): a path that comes to a diffuse surface where the cache
// knows the irradiance takes it and ends, but for the light that it finds straight from an emitter. Elsewhere it goes on.
#pragma once

#include <algorithm>
#include <utility>

#include "integrators/irradiance/irradiance_cache.h"
#include "integrators/path/path_group.h"

namespace fluxfarm {

// Whether what a surface scatters is its albedo over pi times its irradiance, and nothing else.
inline bool takes_irradiance(const Scene::Surface& surface) {
  return surface.has_continuous_lobe && !surface.glossy && !surface.chooses_lobe && !surface.transmits;
}

// Of a surface that takes_irradiance(), on the side where the path is.
inline ReceivingPlace receiving_place(const PathVertex& vertex, int room) {
  return {vertex.point.position, vertex.frame.n, std::min(room, IrradianceRecord::kMostRoom)};
}

// `Photons` carry a part of the light, or none.
template <typename Photons>
class CachedIrradiance {
 public:
  CachedIrradiance(const IrradianceCache& cache, Photons photons) : cache_(cache), photons_(std::move(photons)) {}

  static constexpr bool kInMedia = false;
  struct State {
    typename Photons::State photons;
    std::uint32_t replicate = 0;
    bool cached = false;  // all but the light of emitters has been taken from the cache
  };
  State start(const CameraSample& sample) const { return {photons_.start(sample), sample.index % kReplicates, false}; }
  void arrive(State& state, float distance) const { photons_.arrive(state.photons, distance); }
  bool ended(const State& state) const { return state.cached; }
  void scatter(State& state, const BsdfSample& sample) const { photons_.scatter(state.photons, sample); }

  void gather(State& state, const PathVertex& vertex, int room, const Rgb& throughput, const LightHistory& history,
              SampleResult& result) {
    photons_.gather(state.photons, vertex, room, throughput, history, result);
    if (!takes_irradiance(*vertex.surface) || !(vertex.wo.z > 0)) return;
    const auto found = cache_.interpolate(receiving_place(vertex, room), state.replicate);
    if (!found) return;
    const Rgb scattered = throughput * vertex.bsdf->albedo(vertex.wo) * kInvPi;
    result.add(scattered * found->irradiance, history.layer_by_indirect());
    result.bias += scattered * found->error;
    state.cached = true;
  }

  float left_of_map(const State& state, Vec3f direction) const { return photons_.left_of_map(state.photons, direction); }
  // The constant environment is part of the irradiance.
  float left_of_constant(const State& state) const { return state.cached ? 0 : photons_.left_of_constant(state.photons); }
  float left_of_found(const State& state, const AreaEmitter& emitter, const SurfacePoint& point, Vec3f direction) const {
    return photons_.left_of_found(state.photons, emitter, point, direction);
  }
  float left_of_asked(const State& state, const Rgb& f, const Emitter& emitter, const EmitterSample& light) const {
    return photons_.left_of_asked(state.photons, f, emitter, light);
  }

 private:
  const IrradianceCache& cache_;
  Photons photons_;
};

}  // namespace fluxfarm
