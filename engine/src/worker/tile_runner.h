// Renders one tile over one sample range: hands the method batches of camera samples and sums what comes back.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

#include "accel/ray_queries.h"
#include "film/tile_sums.h"
#include "integrators/integrator.h"

namespace fluxfarm {

struct TileTask {
  PixelRect rect;
  SampleRange samples;
  std::uint64_t seed = 0;
  const PreparedPass* pass = nullptr;  // of the method, for these samples or more of the same pass
};

// The sums depend on the scene, the method and the task alone. `progress` is told of each batch's number of samples, on the calling
// thread; it may be empty. Throws CancelledError soon after `cancelled` becomes true.
TileSums render_tile(const Scene& scene, const Integrator& integrator, const TileTask& task, RayQueries& queries,
                     const std::atomic<bool>& cancelled, const std::function<void(std::uint64_t)>& progress = {});

}  // namespace fluxfarm
