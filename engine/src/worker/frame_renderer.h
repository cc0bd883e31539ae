// Renders a whole frame in this process: the engine alone, without a service. The same passes, tiles and sums as the farm, so the
// same bits.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "film/film.h"
#include "film/goal.h"
#include "integrators/integrator.h"
#include "worker/pilot_samples.h"

namespace fluxfarm {

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

// `after_pass` is called at each pass barrier; it may be empty. What a pilot made of this picture is taken from `known`; the bits
// are the same without it. Throws CancelledError when `cancelled` becomes true.
FrameResult render_frame(const Scene& scene, const Integrator& integrator, const FrameSettings& settings,
                         const std::atomic<bool>& cancelled, const std::function<void(const TimelinePoint&)>& after_pass = {},
                         const PilotSamples& known = {});

}  // namespace fluxfarm
