// Progressive photon mapping for caustics, path tracing for all other light. Consistent: biased by blur that goes to zero.
//
// Light that reaches a surface through sharp scattering, from mirrors, glass or glossy metal, is carried by photons (sharpness.h
// says how much of it) and gathered at every surface with a continuous lobe that a path meets, seen directly, in mirrors, through
// glass or after other bounces. Everything else the path tracer finds, with PathIntegrator's parameters.
//
// Good for: caustics, also of small and of point lights, and caustics seen through glass. Where nothing scatters sharply it is the
// path tracer, and shoots nothing. Poor for: caustics much finer than a pixel's side in a few passes; light through small openings.
// In media it goes on from VolumePathIntegrator: collisions scatter like surfaces, and photons that collide are gathered along
// every ray of a path.
//
// [KnausZwicker11] C. Knaus, M. Zwicker, "Progressive Photon Mapping: A Probabilistic Approach", ACM TOG 30(3), 2011.
#pragma once

#include <optional>

#include "integrators/integrator.h"
#include "integrators/photon/projection_map.h"

namespace fluxfarm {

class PhotonProgressiveIntegrator final : public Integrator {
 public:
  const char* name() const override { return "photon-progressive"; }
  Bias bias() const override { return paths_ ? Bias::kNone : Bias::kFalling; }
  MethodParts parts() const override;
  bool finds_caustics() const override { return true; }
  // Throws SettingError if the scene has nothing to shoot or to shoot at.
  void prepare(const Scene& scene) override;
  std::shared_ptr<const PreparedPass> prepare_pass(std::uint64_t seed, SampleRange samples, int threads,
                                                   const std::atomic<bool>& cancelled) const override;
  void radiance(std::span<const CameraSample> samples, std::uint64_t seed, const PreparedPass* pass,
                std::span<SampleResult> results, RayQueries& queries) const override;

 private:
  const Scene* scene_ = nullptr;
  std::optional<ProjectionMap> projection_;  // nothing: photons start everywhere
  std::unique_ptr<Integrator> paths_;        // does all the work where no photon can become a caustic; else null
};

}  // namespace fluxfarm
