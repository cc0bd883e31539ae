// Photon mapping in two passes: direct light by the path tracer's means, caustics and indirect light from photon maps. Biased: by
// blur that does not go away as samples are added, for each pass has maps of its own, as coarse as those before.
//
// Parameters (MethodDescription): photons, of each of the two kinds of maps for each sample of the pixels; final_gather, whether
// indirect light is gathered by a ray or read where the path is; max_depth, rr_depth and hide_emitters as of the path tracer.
//
// Good for: a quick look at all light, caustics and light from enclosed sources with them. Poor for: contact shadows, and other
// light that changes within a disk of photons, in a direct look; error.bias tells how much. Edges, corners and thin walls are known
// to the disks (disk_in_sight.h). Participating media are not modelled.
//
// Each replicate and each pass has photons of its own: error.noise holds their noise, and it falls as samples are added.
//
// [Jensen96] H. W. Jensen, "Global Illumination using Photon Maps", EGWR 1996.
#pragma once

#include <memory>
#include <optional>

#include "integrators/integrator.h"
#include "integrators/photon/projection_map.h"

namespace fluxfarm {

class PhotonIntegrator final : public Integrator {
 public:
  const char* name() const override { return "photon"; }
  Bias bias() const override { return Bias::kFixed; }
  MethodParts parts() const override {
    const bool caustics = !projection_->empty();
    return {.caustic_map = caustics, .global_map = true, .projection_map = caustics};
  }
  bool finds_caustics() const override { return true; }
  // Throws SettingError if the scene has nothing to shoot or to shoot at.
  void prepare(const Scene& scene) override;
  std::shared_ptr<const PreparedPass> prepare_pass(std::uint64_t seed, SampleRange samples, int threads,
                                                   const std::atomic<bool>& cancelled) const override;
  void radiance(std::span<const CameraSample> samples, std::uint64_t seed, const PreparedPass* pass,
                std::span<SampleResult> results, RayQueries& queries) const override;

 private:
  const Scene* scene_ = nullptr;
  std::optional<ProjectionMap> projection_;  // for caustics
};

}  // namespace fluxfarm
