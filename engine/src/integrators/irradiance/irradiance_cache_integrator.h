// Irradiance caching: indirect light on diffuse surfaces from few places where it is gathered well, direct light and all else by
// paths. Biased, by interpolation between records; the bias falls as samples are added (cache_quality.h).
//
// Parameters (MethodDescription): max_depth, rr_depth and hide_emitters as of the path tracer.
//
// Good for: rooms with diffuse walls. Poor for: caustics, which the records' paths find as badly as all paths; detail finer than a
// few pixels, where no record is made and paths are traced. Surfaces that are not diffuse are path traced. Participating media are
// not modelled.
//
// Each of a pixel's replicates takes the light of its own strata of each record's hemisphere: error.noise holds the records' noise.
// error.bias is what the records' Hessians say that their gradients leave out.
//
// [Ward88] G. Ward, F. Rubinstein, R. Clear, "A Ray Tracing Solution for Diffuse Interreflection", SIGGRAPH 1988.
#pragma once

#include <memory>

#include "integrators/integrator.h"

namespace fluxfarm {

class IrradianceCacheIntegrator final : public Integrator {
 public:
  const char* name() const override { return "irradiance-cache"; }
  Bias bias() const override { return Bias::kFalling; }
  // Throws SettingError if the scene has what the method does not model.
  void prepare(const Scene& scene) override;
  SampleRange prepared_with(SampleRange samples) const override;
  std::shared_ptr<const PreparedPass> prepare_pass(std::uint64_t seed, SampleRange samples, int threads,
                                                   const std::atomic<bool>& cancelled) const override;
  void radiance(std::span<const CameraSample> samples, std::uint64_t seed, const PreparedPass* pass,
                std::span<SampleResult> results, RayQueries& queries) const override;

 private:
  const Scene* scene_ = nullptr;
};

}  // namespace fluxfarm
