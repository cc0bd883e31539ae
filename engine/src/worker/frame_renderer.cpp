#include "worker/frame_renderer.h"

#include <chrono>
#include <limits>

#include "film/error_goal.h"
#include "film/pass_schedule.h"
#include "film/tile_grid.h"
#include "integrators/audit/light_audit.h"
#include "integrators/light_history.h"
#include "support/parallel.h"
#include "worker/tile_runner.h"

namespace fluxfarm {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

constexpr std::uint32_t kUnbounded = std::numeric_limits<std::uint32_t>::max();

// All samples that are known to be wanted at the beginning: those of a goal other than an error make up one round.
Round begin(const FrameSettings& settings, std::size_t tiles) {
  if (settings.goal.rel_error) return first_round({*settings.goal.rel_error, kUnbounded}, settings.crop);
  Round round{{0, settings.goal.spp.value_or(kUnbounded)}, {}};
  for (std::uint32_t tile = 0; tile < tiles; ++tile) round.tiles.push_back(tile);
  return round;
}

// Cuts a pass to what fits into the time, by the rate so far. False if nothing does.
bool cut_to_time(SampleRange& pass, double seconds, const TimelinePoint& now) {
  const double fits = (seconds - now.seconds) * now.spp / now.seconds;
  if (fits < 0.5) return false;
  pass.end = pass.begin + std::min(pass.size(), static_cast<std::uint32_t>(std::max(1.0, fits)));
  return true;
}

}  // namespace

FrameResult render_frame(const Scene& scene, const Integrator& integrator, const FrameSettings& settings,
                         const std::atomic<bool>& cancelled, const std::function<void(const TimelinePoint&)>& after_pass,
                         const PilotSamples& known) {
  FrameResult result{Film(scene.film().width, scene.film().height, settings.crop, light_layers(scene.census()),
                          integrator.bias() != Integrator::Bias::kNone),
                     {},
                     {},
                     0,
                     0,
                     {},
                     {}};
  const Goal& goal = settings.goal;
  const std::vector<PixelRect> tiles = make_tiles(settings.crop, goal.rel_error ? kErrorTile : settings.tile_size);
  std::vector<RayQueries> queries(static_cast<std::size_t>(settings.threads), RayQueries(scene.accelerator()));
  const Clock::time_point start = Clock::now();
  std::optional<LightAudit> audit;
  if (goal.rel_error) {
    const LightAudit* const made = known.audit(settings.seed);
    audit =
        made ? *made : audit_light(scene, settings.crop, settings.seed, settings.threads, cancelled, integrator.finds_caustics());
  }
  std::uint64_t rays_prepared = 0;  // here, not by the pilot
  double level_rays = 0;            // that preparing what grew last took
  // Time that so many rays take, at the rate so far.
  const auto seconds_of = [&](double rays) {
    double traced = static_cast<double>(rays_prepared);
    for (const RayQueries& query : queries) traced += static_cast<double>(query.rays());
    return rays > 0 ? rays * seconds_since(start) / traced : 0;
  };
  std::optional<Round> round = begin(settings, tiles.size());
  for (int number = 1; round; ++number) {
    std::optional<ErrorLook> look;
    for (std::uint32_t done = round->samples.begin; done < round->samples.end;) {
      SampleRange pass = next_pass(done, round->samples.end);
      const double growth = integrator.growth_at(pass);
      if (goal.seconds && !result.timeline.empty()) {
        const double left_for_it = *goal.seconds - seconds_of(growth * level_rays);
        if (!cut_to_time(pass, left_for_it, result.timeline.back())) break;
      }
      const std::optional<std::shared_ptr<const PreparedPass>> known_pass = known.pass(settings.seed, pass);
      const std::shared_ptr<const PreparedPass> prepared =
          known_pass ? *known_pass : integrator.prepare_pass(settings.seed, pass, settings.threads, cancelled);
      if (prepared) result.rays += prepared->rays();
      if (prepared && !known_pass) rays_prepared += prepared->rays();
      if (prepared && (done == 0 || growth > 0)) level_rays = static_cast<double>(prepared->rays());
      parallel_for(round->tiles.size(), settings.threads, [&](std::size_t index, int thread) {
        const PixelRect rect = tiles[round->tiles[index]];
        // Tiles are disjoint: threads write to different pixels of the film, and only the counter is shared.
        if (const TileSums* sums = known.tile(settings.seed, pass, rect)) return result.film.merge(*sums);
        prepare_render_thread();
        const TileTask task{rect, pass, settings.seed, prepared.get()};
        result.film.merge(render_tile(scene, integrator, task, queries[static_cast<std::size_t>(thread)], cancelled));
      });
      done = pass.end;
      result.summary = result.film.summary(settings.threads);
      TimelinePoint point{seconds_since(start), result.summary.mean_samples, result.summary.error_noise, {}, {}};
      if (goal.rel_error && done == round->samples.end) {
        look = look_at(result.film, {*goal.rel_error, kUnbounded}, number, audit ? &*audit : nullptr,
                       integrator.bias() != Integrator::Bias::kFixed);
        result.error_unseen = look->unseen;
        if (!look->warning.empty()) result.warnings.push_back(look->warning);
        point.error_bound = look->bound;
        point.expected_spp = look->samples / settings.crop.pixels();
      }
      result.timeline.push_back(point);
      if (after_pass) after_pass(result.timeline.back());
    }
    round = look ? std::move(look->next) : std::nullopt;
  }
  result.seconds = seconds_since(start);
  for (const RayQueries& query : queries) result.rays += query.rays();
  return result;
}

}  // namespace fluxfarm
