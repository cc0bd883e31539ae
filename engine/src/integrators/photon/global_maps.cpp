#include "integrators/photon/global_maps.h"

#include <algorithm>

#include "integrators/photon/shoot_photons.h"
#include "sampling/hash.h"

namespace fluxfarm {
namespace {

// Shot for each of the two kinds and each sample that the pixels take, where the scene does not say (a choice).
constexpr std::uint64_t kPhotons = 1 << 14;
// The photons of one pass that are kept at most: 1.6 GB.
constexpr std::size_t kMostStored = std::size_t{1} << 26;

}  // namespace

PhotonSettings global_photon_settings(const Scene& scene, PhotonKinds kinds) {
  const MethodDescription& method = scene.method();
  return {.photons = method.photons > 0 ? method.photons : kPhotons,
          .seed = 0,
          .max_bounces = method.max_depth < 0 ? -1 : method.max_depth - 1,
          .kinds = kinds};
}

GlobalMaps::GlobalMaps(const Scene& scene, const ProjectionMap& projection, std::uint64_t seed, SampleRange samples, int threads,
                       const std::atomic<bool>& cancelled) {
  std::size_t room = kMostStored;
  const auto shoot = [&](const PhotonSettings& settings, const PhotonTracer& tracer) {
    const ShotPhotons shot = shoot_photons(scene, tracer, {0, settings.photons}, room, threads, cancelled);
    room -= shot.photons.size() + shot.in_media.size();
    rays_ += shot.rays;
    return PhotonMap(shot.photons, threads);
  };
  for (std::uint32_t i = samples.begin; i < std::min(samples.begin + kReplicates, samples.end); ++i) {
    const std::uint64_t own = (samples.end - i + kReplicates - 1) / kReplicates;  // samples of the replicate
    PhotonSettings caustic = global_photon_settings(scene, PhotonKinds::caustics());
    PhotonSettings indirect = global_photon_settings(scene, PhotonKind::kIndirect);
    caustic.photons *= own;
    indirect.photons *= own;
    caustic.seed = hash_words(seed, i, 0);
    indirect.seed = hash_words(seed, i, 1);
    if (!projection.empty()) caustics_[i % kReplicates] = shoot(caustic, PhotonTracer(scene, caustic, projection));
    indirect_[i % kReplicates] = shoot(indirect, PhotonTracer(scene, indirect));
  }
}

}  // namespace fluxfarm
