#include "integrators/photon/shoot_photons.h"

#include <algorithm>
#include <string>

#include "support/error.h"
#include "support/parallel.h"

namespace fluxfarm {
namespace {

ShotPhotons shoot_batch(const Scene& scene, const PhotonTracer& tracer, PhotonRange range) {
  ShotPhotons batch;
  RayQueries queries(scene.accelerator());
  for (std::uint64_t first = range.begin; first < range.end; first += PhotonTracer::kGroup) {
    const std::size_t count = std::min<std::uint64_t>(PhotonTracer::kGroup, range.end - first);
    tracer.trace(first, count, queries, batch, batch.ledger);
  }
  batch.rays = queries.rays();
  return batch;
}

}  // namespace

ShotPhotons shoot_photons(const Scene& scene, const PhotonTracer& tracer, PhotonRange range, std::size_t max_stored, int threads,
                          const std::atomic<bool>& cancelled) {
  std::vector<ShotPhotons> batches((range.end - range.begin + kPhotonBatch - 1) / kPhotonBatch);
  std::atomic<std::size_t> stored{0};
  parallel_for(batches.size(), threads, [&](std::size_t index, int) {
    if (cancelled.load(std::memory_order_relaxed)) throw CancelledError();
    prepare_render_thread();
    const std::uint64_t begin = range.begin + index * kPhotonBatch;
    batches[index] = shoot_batch(scene, tracer, {begin, std::min(begin + kPhotonBatch, range.end)});
    if ((stored += batches[index].photons.size() + batches[index].in_media.size()) > max_stored) {
      throw ResourceError("more than the " + std::to_string(max_stored) + " photons that there is memory left for; shoot fewer");
    }
  });
  ShotPhotons shot;
  std::size_t at_surfaces = 0;
  for (const ShotPhotons& batch : batches) at_surfaces += batch.photons.size();
  shot.photons.reserve(at_surfaces);
  shot.in_media.reserve(stored - at_surfaces);
  for (ShotPhotons& batch : batches) {
    shot.photons.insert(shot.photons.end(), batch.photons.begin(), batch.photons.end());
    shot.in_media.insert(shot.in_media.end(), batch.in_media.begin(), batch.in_media.end());
    shot.ledger.add(batch.ledger);
    shot.rays += batch.rays;
    batch = {};
  }
  return shot;
}

}  // namespace fluxfarm
