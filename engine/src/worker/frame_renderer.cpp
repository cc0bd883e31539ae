#include "worker/frame_renderer.h"

#include <chrono>
#include <cmath>
#include <limits>

#include "film/pass_schedule.h"
#include "support/parallel.h"
#include "worker/tile_runner.h"

namespace fluxfarm {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// The next pass, or nothing when the goal is reached. With a time goal the pass is cut to what fits, by the rate so far.
std::optional<SampleRange> choose_pass(const Goal& goal, const std::vector<TimelinePoint>& timeline) {
  if (timeline.empty()) return next_pass(0, goal.spp.value_or(1));
  const TimelinePoint& now = timeline.back();
  if (goal.spp) {
    if (now.spp >= *goal.spp) return std::nullopt;
    return next_pass(now.spp, *goal.spp);
  }
  if (goal.rel_error && now.error_bound && *now.error_bound <= *goal.rel_error) return std::nullopt;
  SampleRange pass = next_pass(now.spp, std::numeric_limits<std::uint32_t>::max());
  if (goal.seconds) {
    const double left = *goal.seconds - now.seconds;
    const double fits = left * now.spp / now.seconds;
    if (fits < 0.5) return std::nullopt;
    pass.end = pass.begin + std::min(pass.size(), static_cast<std::uint32_t>(std::max(1.0, fits)));
  }
  return pass;
}

}  // namespace

FrameResult render_frame(const Scene& scene, const Integrator& integrator, const FrameSettings& settings,
                         const std::atomic<bool>& cancelled, const std::function<void(const TimelinePoint&)>& after_pass) {
  FrameResult result{Film(scene.film().width, scene.film().height, settings.crop), {}, {}, 0, 0};
  const std::vector<PixelRect> tiles = make_tiles(settings.crop, settings.tile_size);
  std::vector<RayQueries> queries(static_cast<std::size_t>(settings.threads), RayQueries(scene.accelerator()));
  const Clock::time_point start = Clock::now();
  while (const std::optional<SampleRange> pass = choose_pass(settings.goal, result.timeline)) {
    parallel_for(tiles.size(), settings.threads, [&](std::size_t index, int thread) {
      prepare_render_thread();
      const TileTask task{tiles[index], *pass, settings.seed};
      // Tiles are disjoint: threads write to different pixels of the film, and only the counter is shared.
      result.film.merge(render_tile(scene, integrator, task, queries[static_cast<std::size_t>(thread)], cancelled));
    });
    result.summary = result.film.summary();
    const std::optional<double> bound = settings.goal.rel_error ? result.film.error_bound() : std::nullopt;
    result.timeline.push_back({seconds_since(start), pass->end, result.summary.error_noise, bound});
    if (after_pass) after_pass(result.timeline.back());
  }
  result.seconds = seconds_since(start);
  for (const RayQueries& query : queries) result.rays += query.rays();
  return result;
}

}  // namespace fluxfarm
