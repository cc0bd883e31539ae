// Renders a whole frame in this process: the engine alone, without a service. The same passes, tiles and sums as the farm, so the
// same bits.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "film/film.h"
#include "integrators/integrator.h"

namespace fluxfarm {

// When to stop. Exactly one is set.
struct Goal {
  std::optional<std::uint32_t> spp;
  std::optional<double> seconds;    // wall time of the passes
  std::optional<double> rel_error;  // sqrt(relMSE), with 95 % confidence (film/error_goal.h)
};

struct FrameSettings {
  PixelRect crop;
  int tile_size = 64;  // an error goal has its own
  int threads = 1;
  std::uint64_t seed = 0;
  Goal goal;
};

// State after a pass.
struct TimelinePoint {
  double seconds = 0;                  // since the first pass began, or the audit before it
  double spp = 0;                      // mean over the pixels
  std::optional<double> error;         // FilmSummary::error_noise
  std::optional<double> error_bound;   // ErrorLook::bound, after a round towards an error goal
  std::optional<double> expected_spp;  // ErrorLook::samples over the pixels, after such a round
};

struct FrameResult {
  Film film;
  FilmSummary summary;
  std::vector<TimelinePoint> timeline;
  std::uint64_t rays = 0;
  double seconds = 0;                  // from the same moment on
  std::optional<double> error_unseen;  // ErrorLook::unseen of the last look
  std::vector<std::string> warnings;
};

// `after_pass` is called at each pass barrier; it may be empty. Throws CancelledError when `cancelled` becomes true.
FrameResult render_frame(const Scene& scene, const Integrator& integrator, const FrameSettings& settings,
                         const std::atomic<bool>& cancelled, const std::function<void(const TimelinePoint&)>& after_pass = {});

}  // namespace fluxfarm
