// Irradiance caching: indirect light on diffuse surfaces from few places where it is gathered well, direct light and all else by
// paths. Biased, by interpolation between records; the bias falls as samples are added (cache_quality.h).
//
// Parameters (MethodDescription): max_depth, rr_depth and hide_emitters as of the path tracer.
//
// Good for: rooms with diffuse walls. Poor for: detail finer than a few pixels, where no record is made and paths are traced; small
// bright spots that light a room, which hardly a path of a record finds: error.noise and the bound of an error goal say so
// (catalogue G7). Surfaces that are not diffuse are path traced. In a scene with glossy surfaces photons carry caustics, as in
// photon-progressive. Participating media are not modelled.
//
// Each of a pixel's replicates takes the light of its own strata of each record's hemisphere: error.noise holds the records' noise.
// error.bias is what the records allow for beside it: their Hessians, what is near, and their gradients' noise.
//
// [Ward88] G. Ward, F. Rubinstein, R. Clear, "A Ray Tracing Solution for Diffuse Interreflection", SIGGRAPH 1988.
#pragma once

#include <list>
#include <memory>
#include <mutex>
#include <optional>

#include "integrators/integrator.h"
#include "integrators/irradiance/irradiance_cache.h"
#include "integrators/photon/projection_map.h"

namespace fluxfarm {

class IrradianceCacheIntegrator final : public Integrator {
 public:
  const char* name() const override { return "irradiance-cache"; }
  Bias bias() const override { return paths_ ? Bias::kNone : Bias::kFalling; }
  MethodParts parts() const override {
    const bool caustics = projection_.has_value();
    return {.caustic_map = caustics, .projection_map = caustics, .irradiance_cache = !paths_};
  }
  bool finds_caustics() const override { return projection_.has_value(); }
  // Throws SettingError if the scene has what the method does not model.
  void prepare(const Scene& scene) override;
  std::shared_ptr<const PreparedPass> prepare_pass(std::uint64_t seed, SampleRange samples, int threads,
                                                   const std::atomic<bool>& cancelled) const override;
  double growth_at(SampleRange samples) const override;
  void radiance(std::span<const CameraSample> samples, std::uint64_t seed, const PreparedPass* pass,
                std::span<SampleResult> results, RayQueries& queries) const override;

 private:
  struct Level {
    std::uint64_t seed = 0;
    SampleRange samples;
    std::shared_ptr<const IrradianceCache> cache;
    std::uint64_t rays = 0;  // that it took, and those before it that had to be made
  };
  // With mutex_ held.
  Level level(std::uint64_t seed, SampleRange samples, int threads, const std::atomic<bool>& cancelled) const;

  const Scene* scene_ = nullptr;
  std::optional<ProjectionMap> projection_;  // for caustics; nothing: there are none, or emitters cannot shine there
  // The levels that were asked for last: several passes share a cache, and rounds of an error goal go back and forth.
  mutable std::mutex mutex_;
  mutable std::list<Level> levels_;    // most recently used first
  std::unique_ptr<Integrator> paths_;  // does all the work where no surface is diffuse; else null
};

}  // namespace fluxfarm
