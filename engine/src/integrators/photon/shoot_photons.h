// Shoots many photons on several threads. What comes back does not depend on how many those are.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "integrators/photon/flux_ledger.h"
#include "integrators/photon/photon.h"
#include "integrators/photon/photon_tracer.h"

namespace fluxfarm {

// Work is handed out in batches of so many photons. Ranges that begin and end at multiples of it give, one after the other, the
// photons of their union, bit by bit.
inline constexpr std::uint64_t kPhotonBatch = 4096;

// Half-open.
struct PhotonRange {
  std::uint64_t begin = 0, end = 0;
};

struct ShotPhotons : StoredPhotons {  // in the order of their indices
  FluxLedger ledger;
  std::uint64_t rays = 0;
};

// Shoots the photons of `range`. Keeps at most `max_stored` of them: throws ResourceError if there are more. Throws
// CancelledError soon after `cancelled` becomes true.
ShotPhotons shoot_photons(const Scene& scene, const PhotonTracer& tracer, PhotonRange range, std::size_t max_stored, int threads,
                          const std::atomic<bool>& cancelled);

}  // namespace fluxfarm
