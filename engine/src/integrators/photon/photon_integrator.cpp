#include "integrators/photon/photon_integrator.h"

#include "integrators/path/path_group.h"
#include "integrators/photon/global_maps.h"
#include "integrators/photon/global_photons.h"
#include "integrators/photon/photon_tracer.h"
#include "integrators/photon/projection_pilot.h"
#include "support/error.h"

namespace fluxfarm {

void PhotonIntegrator::prepare(const Scene& scene) {
  if (scene.census().media > 0 || scene.census().null_boundaries) {
    throw SettingError("the scene has participating media or null boundaries, which the method photon does not model");
  }
  const PhotonTracer checked(scene, global_photon_settings(scene, PhotonKinds::all()));
  scene_ = &scene;
  projection_.emplace(caustic_projection(scene, global_photon_settings(scene, PhotonKinds::caustics())));
}

std::shared_ptr<const PreparedPass> PhotonIntegrator::prepare_pass(std::uint64_t seed, SampleRange samples, int threads,
                                                                   const std::atomic<bool>& cancelled) const {
  return std::make_shared<GlobalMaps>(*scene_, *projection_, seed, samples, threads, cancelled);
}

void PhotonIntegrator::radiance(std::span<const CameraSample> samples, std::uint64_t seed, const PreparedPass* pass,
                                std::span<SampleResult> results, RayQueries& queries) const {
  const auto& maps = *static_cast<const GlobalMaps*>(pass);
  PathGroup<GlobalPhotons> group(*scene_, {*scene_, maps, seed, queries}, queries);
  for_each_group(samples, results,
                 [&](std::span<const CameraSample> block, std::span<SampleResult> out) { group.trace(block, seed, out); });
}

}  // namespace fluxfarm
