#include "integrators/irradiance/irradiance_cache_integrator.h"

#include "integrators/irradiance/cached_irradiance.h"
#include "integrators/irradiance/overture.h"
#include "sampling/hash.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

class CachedPass final : public PreparedPass {
 public:
  explicit CachedPass(Overture overture) : overture_(std::move(overture)) {}

  const IrradianceCache& cache() const { return overture_.cache; }
  std::uint64_t rays() const override { return overture_.rays; }

 private:
  Overture overture_;
};

}  // namespace

void IrradianceCacheIntegrator::prepare(const Scene& scene) {
  if (scene.census().media > 0 || scene.census().null_boundaries) {
    throw SettingError("the scene has participating media or null boundaries, which the method irradiance-cache does not model");
  }
  scene_ = &scene;
}

SampleRange IrradianceCacheIntegrator::prepared_with(SampleRange samples) const { return cache_level(samples); }

std::shared_ptr<const PreparedPass> IrradianceCacheIntegrator::prepare_pass(std::uint64_t seed, SampleRange samples, int threads,
                                                                            const std::atomic<bool>& cancelled) const {
  const SampleRange level = cache_level(samples);
  return std::make_shared<CachedPass>(make_overture(*scene_, hash_words(seed, level.begin), quality_of(level), threads, cancelled));
}

void IrradianceCacheIntegrator::radiance(std::span<const CameraSample> samples, std::uint64_t seed, const PreparedPass* pass,
                                         std::span<SampleResult> results, RayQueries& queries) const {
  const auto& cached = *static_cast<const CachedPass*>(pass);
  PathGroup<CachedIrradiance> group(*scene_, CachedIrradiance(cached.cache()), queries);
  for_each_group(samples, results,
                 [&](std::span<const CameraSample> block, std::span<SampleResult> out) { group.trace(block, seed, out); });
}

}  // namespace fluxfarm
