#include "integrators/photon/photon_progressive_integrator.h"

#include "integrators/path/path_group.h"
#include "integrators/photon/caustic_maps.h"
#include "integrators/photon/caustic_photons.h"
#include "integrators/photon/photon_tracer.h"
#include "integrators/photon/projection_pilot.h"
#include "support/error.h"

namespace fluxfarm {

void PhotonProgressiveIntegrator::prepare(const Scene& scene) {
  if (scene.census().media > 0 || scene.census().null_boundaries) {
    throw SettingError("the scene has participating media or null boundaries, which the method photon-progressive does not model");
  }
  const PhotonTracer checked(scene, caustic_photon_settings(scene));
  scene_ = &scene;
  projection_.emplace(caustic_projection(scene, caustic_photon_settings(scene)));
}

std::shared_ptr<const PreparedPass> PhotonProgressiveIntegrator::prepare_pass(std::uint64_t seed, SampleRange samples, int threads,
                                                                              const std::atomic<bool>& cancelled) const {
  return std::make_shared<CausticMaps>(*scene_, *projection_, seed, samples, threads, cancelled);
}

void PhotonProgressiveIntegrator::radiance(std::span<const CameraSample> samples, std::uint64_t seed, const PreparedPass* pass,
                                           std::span<SampleResult> results, RayQueries& queries) const {
  const auto& maps = *static_cast<const CausticMaps*>(pass);
  PathGroup<CausticPhotons> group(*scene_, {*scene_, maps}, queries);
  for_each_group(samples, results,
                 [&](std::span<const CameraSample> block, std::span<SampleResult> out) { group.trace(block, seed, out); });
}

}  // namespace fluxfarm
