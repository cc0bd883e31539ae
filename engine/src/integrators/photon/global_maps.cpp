#include "integrators/photon/global_maps.h"

#include <algorithm>

#include "integrators/photon/shoot_photons.h"
#include "sampling/hash.h"

namespace fluxfarm {
namespace {

// Shot for each of the two kinds, over all replicates, where the scene does not say (a choice: a second on two cores).
constexpr std::uint64_t kPhotons = 1 << 20;
// The photons of one map that are kept at most: 8 x 2 maps take 3 GB then.
constexpr std::size_t kMostStored = std::size_t{1} << 23;

}  // namespace

PhotonSettings global_photon_settings(const Scene& scene, PhotonKinds kinds) {
  const MethodDescription& method = scene.method();
  const std::uint64_t photons = method.photons > 0 ? method.photons : kPhotons;
  return {.photons = std::max<std::uint64_t>(photons / kReplicates, 1),
          .seed = 0,
          .max_bounces = method.max_depth < 0 ? -1 : method.max_depth - 1,
          .kinds = kinds};
}

GlobalMaps::GlobalMaps(const Scene& scene, const ProjectionMap& projection, std::uint64_t seed, int threads,
                       const std::atomic<bool>& cancelled) {
  const auto shoot = [&](const PhotonSettings& settings, const PhotonTracer& tracer) {
    const ShotPhotons shot = shoot_photons(scene, tracer, {0, settings.photons}, kMostStored, threads, cancelled);
    rays_ += shot.rays;
    return PhotonMap(shot.photons, threads);
  };
  PhotonSettings caustic = global_photon_settings(scene, PhotonKinds::caustics());
  PhotonSettings indirect = global_photon_settings(scene, PhotonKind::kIndirect);
  for (std::uint32_t replicate = 0; replicate < kReplicates; ++replicate) {
    caustic.seed = hash_words(seed, replicate, 0);
    indirect.seed = hash_words(seed, replicate, 1);
    if (!projection.empty()) caustics_[replicate] = shoot(caustic, PhotonTracer(scene, caustic, projection));
    indirect_[replicate] = shoot(indirect, PhotonTracer(scene, indirect));
  }
}

}  // namespace fluxfarm
