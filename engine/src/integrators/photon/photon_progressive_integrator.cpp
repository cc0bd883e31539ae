#include "integrators/photon/photon_progressive_integrator.h"

#include <algorithm>

#include "integrators/path/path_group.h"
#include "integrators/path/volume_path_group.h"
#include "integrators/photon/caustic_maps.h"
#include "integrators/photon/caustic_photons.h"
#include "integrators/photon/photon_tracer.h"
#include "integrators/photon/projection_pilot.h"

namespace fluxfarm {

namespace {

// Whether some medium scatters sharply, so that photons that start anywhere may become caustics there.
bool has_sharp_media(const Scene& scene) {
  const std::vector<HomogeneousMedium>& media = scene.media();
  return std::any_of(media.begin(), media.end(), [](const HomogeneousMedium& medium) {
    return !medium.sigma_s().is_black() && sharpness(1 / medium.phase().peak()) > 0;
  });
}

template <typename Group>
void trace_groups(Group& group, std::span<const CameraSample> samples, std::uint64_t seed, std::span<SampleResult> results) {
  for_each_group(samples, results,
                 [&](std::span<const CameraSample> block, std::span<SampleResult> out) { group.trace(block, seed, out); });
}

}  // namespace

void PhotonProgressiveIntegrator::prepare(const Scene& scene) {
  const PhotonTracer checked(scene, caustic_photon_settings(scene));
  scene_ = &scene;
  if (has_sharp_media(scene)) return;
  projection_.emplace(caustic_projection(scene, caustic_photon_settings(scene)));
  if (projection_->empty()) paths_ = make_integrator("path", scene);
}

MethodParts PhotonProgressiveIntegrator::parts() const {
  if (paths_) return {};
  return {.caustic_map = true, .volume_map = scene_->census().media > 0, .projection_map = projection_.has_value()};
}

std::shared_ptr<const PreparedPass> PhotonProgressiveIntegrator::prepare_pass(std::uint64_t seed, SampleRange samples, int threads,
                                                                              const std::atomic<bool>& cancelled) const {
  if (paths_) return nullptr;
  return std::make_shared<CausticMaps>(*scene_, projection_ ? &*projection_ : nullptr, seed, samples, threads, cancelled);
}

void PhotonProgressiveIntegrator::radiance(std::span<const CameraSample> samples, std::uint64_t seed, const PreparedPass* pass,
                                           std::span<SampleResult> results, RayQueries& queries) const {
  if (paths_) return paths_->radiance(samples, seed, pass, results, queries);
  const auto& maps = *static_cast<const CausticMaps*>(pass);
  if (scene_->census().media > 0 || scene_->census().null_boundaries) {
    VolumePathGroup<CausticPhotons> group(*scene_, {*scene_, maps}, queries);
    trace_groups(group, samples, seed, results);
  } else {
    PathGroup<CausticPhotons> group(*scene_, {*scene_, maps}, queries);
    trace_groups(group, samples, seed, results);
  }
}

}  // namespace fluxfarm
