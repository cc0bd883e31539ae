#include "integrators/irradiance/irradiance_cache_integrator.h"

#include <algorithm>
#include <numeric>

#include "integrators/irradiance/cache_quality.h"
#include "integrators/irradiance/cached_irradiance.h"
#include "integrators/irradiance/overture.h"
#include "integrators/light_flux.h"
#include "integrators/photon/caustic_maps.h"
#include "integrators/photon/caustic_photons.h"
#include "integrators/photon/projection_pilot.h"
#include "sampling/hash.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

class CachedPass final : public PreparedPass {
 public:
  CachedPass(std::shared_ptr<const IrradianceCache> cache, std::unique_ptr<const CausticMaps> caustics, std::uint64_t rays)
      : cache_(std::move(cache)), caustics_(std::move(caustics)), rays_(rays) {}

  const IrradianceCache& cache() const { return *cache_; }
  const CausticMaps* caustics() const { return caustics_.get(); }
  std::uint64_t rays() const override { return rays_; }

 private:
  std::shared_ptr<const IrradianceCache> cache_;
  std::unique_ptr<const CausticMaps> caustics_;  // null: photons carry nothing
  std::uint64_t rays_;
};

// Two megabytes of records each, as a rule.
constexpr std::size_t kKeptLevels = 4;

bool has_caustics(const Scene& scene) {
  const std::vector<double> powers = ParticleSource::powers(scene);
  if (!(std::accumulate(powers.begin(), powers.end(), 0.0) > 0)) return false;
  for (std::uint32_t shape = 0; shape < scene.census().shapes; ++shape) {
    if (scene.surface(shape).glossy) return true;
  }
  return false;
}

bool has_diffuse(const Scene& scene) {
  for (std::uint32_t shape = 0; shape < scene.census().shapes; ++shape) {
    if (takes_irradiance(scene.surface(shape))) return true;
  }
  return false;
}

}  // namespace

void IrradianceCacheIntegrator::prepare(const Scene& scene) {
  if (scene.census().media > 0 || scene.census().null_boundaries) {
    throw SettingError("the scene has participating media or null boundaries, which the method irradiance-cache does not model");
  }
  scene_ = &scene;
  if (!has_diffuse(scene)) {
    paths_ = make_integrator("path", scene);
  } else if (has_caustics(scene)) {
    projection_.emplace(caustic_projection(scene, caustic_photon_settings(scene)));
    if (projection_->empty()) projection_.reset();
  }
}

IrradianceCacheIntegrator::Level IrradianceCacheIntegrator::level(std::uint64_t seed, SampleRange samples, int threads,
                                                                  const std::atomic<bool>& cancelled) const {
  const auto known = std::ranges::find_if(levels_, [&](const Level& l) { return l.seed == seed && l.samples == samples; });
  if (known != levels_.end()) {
    levels_.splice(levels_.begin(), levels_, known);
    Level again = *known;
    again.rays = 0;  // it took none this time
    return again;
  }
  Level last;
  if (samples.begin > 0) last = level(seed, cache_level({samples.begin - 1, samples.begin}), threads, cancelled);
  std::optional<CausticMaps> caustics;
  const std::uint64_t own_seed = hash_words(seed, samples.begin);
  if (projection_) caustics.emplace(*scene_, &*projection_, own_seed, SampleRange{0, kReplicates}, threads, cancelled);
  Overture overture =
      make_overture(*scene_, caustics ? &*caustics : nullptr, last.cache.get(), own_seed, quality_of(samples), threads, cancelled);
  levels_.push_front({seed, samples, std::make_shared<const IrradianceCache>(std::move(overture.cache)),
                      last.rays + overture.rays + (caustics ? caustics->rays() : 0)});
  if (levels_.size() > kKeptLevels) levels_.pop_back();
  return levels_.front();
}

std::shared_ptr<const PreparedPass> IrradianceCacheIntegrator::prepare_pass(std::uint64_t seed, SampleRange samples, int threads,
                                                                            const std::atomic<bool>& cancelled) const {
  if (paths_) return nullptr;
  const std::lock_guard lock(mutex_);
  Level made = level(seed, cache_level(samples), threads, cancelled);
  std::unique_ptr<const CausticMaps> caustics;
  if (projection_) {
    caustics = std::make_unique<const CausticMaps>(*scene_, &*projection_, seed, samples, threads, cancelled);
    made.rays += caustics->rays();
  }
  return std::make_shared<CachedPass>(std::move(made.cache), std::move(caustics), made.rays);
}

double IrradianceCacheIntegrator::growth_at(SampleRange samples) const {
  const bool next = !paths_ && samples.begin > 0 && samples.begin == cache_level(samples).begin;
  return next ? kNextLevelGrowth : 0;
}

void IrradianceCacheIntegrator::radiance(std::span<const CameraSample> samples, std::uint64_t seed, const PreparedPass* pass,
                                         std::span<SampleResult> results, RayQueries& queries) const {
  if (paths_) return paths_->radiance(samples, seed, pass, results, queries);
  const auto& cached = *static_cast<const CachedPass*>(pass);
  const auto trace = [&](auto&& group) {
    for_each_group(samples, results,
                   [&](std::span<const CameraSample> block, std::span<SampleResult> out) { group.trace(block, seed, out); });
  };
  if (cached.caustics() == nullptr) {
    using Cached = CachedIrradiance<WithoutPhotons>;
    trace(PathGroup<Cached>(*scene_, Cached(cached.cache(), WithoutPhotons()), queries));
  } else {
    using Cached = CachedIrradiance<CausticPhotons>;
    trace(PathGroup<Cached>(*scene_, Cached(cached.cache(), CausticPhotons(*scene_, *cached.caustics())), queries));
  }
}

}  // namespace fluxfarm
