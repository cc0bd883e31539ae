// Path tracing in scenes with participating media: as PathIntegrator, whose parameters it shares, with scattering between the
// surfaces. Unbiased.
//
// Distances in a medium are sampled in proportion to extinction times transmittance, directions by the phase function; next-event
// estimation from surfaces and from points of media sees lights through null boundaries, dimmed by the media on the way. Light
// that is scattered out of a smooth or rough dielectric is found by BSDF sampling alone, so small lights outside of glass are found
// badly, or, if they are points, never (catalogue 4.8, C8).
//
// A collision counts as a bounce, a null boundary does not. The first surface that the camera's ray meets unscattered, null
// boundaries left aside, gives the features of the sample; a sample that is scattered before has none.
//
// A scene with no medium and no null boundary is rendered by PathIntegrator and runs none of this.
#pragma once

#include "integrators/integrator.h"

namespace fluxfarm {

class VolumePathIntegrator final : public Integrator {
 public:
  const char* name() const override { return "path"; }
  void prepare(const Scene& scene) override { scene_ = &scene; }
  void radiance(std::span<const CameraSample> samples, std::uint64_t seed, const PreparedPass* pass,
                std::span<SampleResult> results, RayQueries& queries) const override;

 private:
  const Scene* scene_ = nullptr;
};

}  // namespace fluxfarm
