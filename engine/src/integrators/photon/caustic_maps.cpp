#include "integrators/photon/caustic_maps.h"

#include <algorithm>
#include <cmath>

#include "integrators/photon/shoot_photons.h"
#include "sampling/hash.h"

namespace fluxfarm {
namespace {

constexpr double kAlpha = 2.0 / 3;

// Photons shot for each sample that the pixels take: one for four pixels, as measured on cornell-glass and water-caustic.
std::uint64_t photons_per_sample(const Scene& scene) {
  if (scene.method().photons > 0) return scene.method().photons;
  const FilmDescription& film = scene.film();
  const std::uint64_t pixels = static_cast<std::uint64_t>(film.width) * static_cast<std::uint64_t>(film.height);
  return std::clamp<std::uint64_t>(pixels / 4, 1 << 12, 1 << 18);
}

// The photons of one pass that are kept at most: 800 MB.
constexpr std::size_t kMostStored = std::size_t{1} << 25;

}  // namespace

PhotonSettings caustic_photon_settings(const Scene& scene) {
  const int max_depth = scene.method().max_depth;
  return {.photons = photons_per_sample(scene),
          .seed = 0,
          .max_bounces = max_depth < 0 ? -1 : max_depth - 1,
          .kinds = PhotonKinds::caustics()};
}

CausticMaps::CausticMaps(const Scene& scene, const ProjectionMap* projection, std::uint64_t seed, SampleRange samples, int threads,
                         const std::atomic<bool>& cancelled)
    : begin_(samples.begin),
      maps_(samples.size()),
      media_maps_(samples.size()),
      radius_(static_cast<float>(static_cast<double>(scene.method().first_radius) * std::pow(samples.end, (kAlpha - 1) / 2))) {
  PhotonSettings settings = caustic_photon_settings(scene);
  std::size_t room = kMostStored;
  for (std::uint32_t i = samples.begin; i < samples.end; ++i) {
    settings.seed = hash_words(seed, i);
    const PhotonTracer tracer = projection != nullptr ? PhotonTracer(scene, settings, *projection) : PhotonTracer(scene, settings);
    const ShotPhotons shot = shoot_photons(scene, tracer, {0, settings.photons}, room, threads, cancelled);
    maps_[i - begin_] = PhotonMap(shot.photons, threads);
    media_maps_[i - begin_] = PhotonMap(shot.in_media, threads);
    room -= shot.photons.size() + shot.in_media.size();
    rays_ += shot.rays;
  }
}

}  // namespace fluxfarm
