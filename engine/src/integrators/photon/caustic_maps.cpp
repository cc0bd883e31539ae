#include "integrators/photon/caustic_maps.h"

#include <algorithm>
#include <cmath>

#include "integrators/light_flux.h"
#include "integrators/photon/photon_tracer.h"
#include "integrators/photon/shoot_photons.h"
#include "sampling/hash.h"

namespace fluxfarm {
namespace {

// Radius over the side of a pixel after the first sample (a choice: smaller is noisier, larger more blurred, at first).
constexpr double kFirstRadius = 4;
constexpr double kAlpha = 2.0 / 3;

// Photons shot for each sample that the pixels take: one for two pixels, which at first leaves less noise than the paths do.
std::uint64_t photons_per_sample(const FilmDescription& film) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(film.width) * static_cast<std::uint64_t>(film.height);
  return std::clamp<std::uint64_t>(pixels / 2, 1 << 12, 1 << 19);
}

// The photons of one map that are kept at most: 800 MB.
constexpr std::size_t kMostStored = std::size_t{1} << 25;

}  // namespace

CausticMaps::CausticMaps(const Scene& scene, std::uint64_t seed, SampleRange samples, int threads,
                         const std::atomic<bool>& cancelled)
    : begin_(samples.begin),
      maps_(samples.size()),
      radius_(static_cast<float>(kFirstRadius * std::pow(samples.end, (kAlpha - 1) / 2))) {
  std::vector<double> weights = ParticleSource::powers(scene);
  weights.resize(scene.emitter_list().size());  // the constant environment looks too large for caustics
  if (std::ranges::none_of(weights, [](double weight) { return weight > 0; })) return;
  const int max_depth = scene.method().max_depth;
  for (std::uint32_t i = samples.begin; i < samples.end; ++i) {
    const PhotonSettings settings{.photons = photons_per_sample(scene.film()),
                                  .seed = hash_words(seed, i),
                                  .max_bounces = max_depth < 0 ? -1 : max_depth - 1,
                                  .kinds = PhotonKinds::caustics()};
    const PhotonTracer tracer(scene, settings, weights);
    const ShotPhotons shot = shoot_photons(scene, tracer, {0, settings.photons}, kMostStored, threads, cancelled);
    maps_[i - begin_] = PhotonMap(shot.photons, threads);
    rays_ += shot.rays;
  }
}

}  // namespace fluxfarm
