// Irradiance from a cache on behalf of a group of paths (path/path_group.h): a path that comes to a diffuse surface where the cache
// knows the irradiance takes it and ends, but for the light that it finds straight from an emitter. Elsewhere it goes on.
#pragma once

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

class CachedIrradiance : public WithoutPhotons {
 public:
  explicit CachedIrradiance(const IrradianceCache& cache) : cache_(cache) {}

  struct State {
    std::uint32_t replicate = 0;
    bool cached = false;  // all but the light of emitters has been taken from the cache
  };
  State start(const CameraSample& sample) const { return {.replicate = sample.index % kReplicates}; }
  void arrive(State&, float) const {}
  bool ended(const State& state) const { return state.cached; }
  void scatter(State&, const BsdfSample&) const {}

  void gather(State& state, const PathVertex& vertex, int room, const Rgb& throughput, const LightHistory& history,
              SampleResult& result) const {
    if (!takes_irradiance(*vertex.surface) || !(vertex.wo.z > 0)) return;
    const auto found = cache_.interpolate(receiving_place(vertex, room), state.replicate);
    if (!found) return;
    const Rgb scattered = throughput * vertex.bsdf->albedo(vertex.wo) * kInvPi;
    result.add(scattered * found->irradiance, history.layer_by_indirect());
    result.bias += scattered * found->error;
    state.cached = true;
  }

  float left_of_map(const State&, Vec3f) const { return 1; }
  // The constant environment is part of the irradiance.
  float left_of_constant(const State& state) const { return state.cached ? 0 : 1; }
  float left_of_found(const State&, const AreaEmitter&, const SurfacePoint&, Vec3f) const { return 1; }
  float left_of_asked(const State&, const Rgb&, const Emitter&, const EmitterSample&) const { return 1; }

 private:
  const IrradianceCache& cache_;
};

}  // namespace fluxfarm
