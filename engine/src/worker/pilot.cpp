#include "worker/pilot.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "film/error_goal.h"
#include "film/tile_grid.h"
#include "integrators/audit/light_audit.h"
#include "integrators/irradiance/cache_quality.h"
#include "integrators/plan/method_forecast.h"
#include "support/error.h"
#include "worker/pilot_trial.h"

namespace fluxfarm {
namespace {

// Time of a ray of a method over that of one of path tracing, with all that is done about it; measured on our scenes with 8 to 129
// samples (engine/docs/decisions/0012): photons 1.3 to 1.9, caches 1.2 to 1.7, with photons 1.7 to 2.5.
constexpr double kRayWithPhotons = 1.6, kRayWithCache = 1.5, kRayWithBoth = 2.3;

// Samples of each pixel of a trial: one in each replicate, the fewest that tell of noise, and at most so many. They go on,
// doubling, while trials of methods that are not likely to be taken cost no more than a part of the work that the likely one needs.
constexpr std::uint32_t kTrialSamples = 8, kMostTrialSamples = 64;
constexpr double kForTrials = 0.05;
// Methods of which more than so many times the cost is foretold are given up before.
constexpr double kStillLikely = 4;
// Of what the picture may take of its pixels, at most so much is taken ahead in a few tiles.
constexpr double kTakenAhead = 0.25;

// Before a cache is tried: what its first level may take, in samples of path tracing; and how much of the noise that a method is
// there to take away it may leave, at best.
constexpr double kHopedAhead = 12, kHopedLeft = 0.05;

// Each pixel of the frame takes a hundred bytes while a cache is made.
constexpr std::int64_t kMostPixelsOfACache = 1 << 24;

// A path that finds a caustic brings back about so much of the lamp's radiance: a diffuse surface and some glass are in between.
constexpr double kLeftOfLamp = 0.5;

std::string percent(double share) { return std::to_string(std::lround(100 * share)) + " %"; }

double work_of_ray(const Integrator& integrator) {
  const MethodParts parts = integrator.parts();
  if (parts.irradiance_cache) return parts.caustic_map ? kRayWithBoth : kRayWithCache;
  return parts.caustic_map ? kRayWithPhotons : 1;
}

// Of the brightest lamp, mean over R, G, B. Light from outside the scene is left out.
double brightest_radiance(const Scene& scene) {
  float brightest = 0;
  for (const Emitter* emitter : scene.emitter_list()) {
    if (const auto* area = dynamic_cast<const AreaEmitter*>(emitter)) brightest = std::max(brightest, mean(area->radiance()));
  }
  return static_cast<double>(brightest);
}

bool has_unreachable_light(const Scene& scene) {
  const Census& census = scene.census();
  return census.delta_lobes && census.point_emitters + census.spot_emitters + census.directional_emitters > 0;
}

struct Contender {
  std::string method;
  std::unique_ptr<Integrator> integrator;  // null: does not suit the scene
  std::string reason;                      // why
  std::optional<PilotTrial> trial;
  double indirect = 0;  // part of its noise by indirect light
  std::optional<MethodTrial> figures;
};

Contender contender(const std::string& method, const Scene& scene, const char* without_parts) {
  Contender result{method, nullptr, {}, {}, 0, {}};
  try {
    result.integrator = make_integrator(method, scene);
    if (!result.integrator->parts().any()) {
      result.integrator.reset();
      result.reason = without_parts;
    }
  } catch (const SettingError& error) {
    result.reason = error.what();
  }
  return result;
}

// What light that was scattered sharply adds to the variance of path tracing, by the side of the light: as a share of relMSE, a
// mean over the pixels, after one sample of each.
double sharp_square(const LightAudit& audit, PixelRect crop) {
  double sum = 0;
  const std::vector<PixelRect> rects = make_tiles(crop, kErrorTile);
  for (std::size_t i = 0; i < audit.cells.size(); ++i) {
    const LightAudit::Cell& cell = audit.cells[i];
    sum += rects[i].pixels() * cell.sharp_square / (cell.radiance * cell.radiance + 1e-2);
  }
  return sum / crop.pixels();
}

class PilotRun {
 public:
  PilotRun(const PilotTask& task, const Goal& goal) : task_(task), goal_(goal) {}

  void run(Contender& path, Contender& photons, Contender& cache, const LightAudit& audit) const {
    try_out(path);
    const double sharp = sharp_square(audit, task_.crop);
    path.figures->unmet_noise = std::max(sharp - settled_noise(*path.figures), 0.0);
    if (photons.integrator && !photons_may_gain(path, sharp)) {
      photons.reason = "light from mirrors and gloss makes too little of the noise for the shooting of photons";
    } else if (photons.integrator && fits(photons)) {
      path.figures->unmet_noise = unmet(path, photons, sharp);
    }
    const Contender& last = photons.figures ? photons : path;
    if (cache.integrator && scene_pixels() > kMostPixelsOfACache) {
      cache.reason = "the frame has more than " + std::to_string(kMostPixelsOfACache) + " pixels";
    } else if (cache.integrator && !cache_may_gain(last, path)) {
      cache.reason = "indirect light makes " + percent(last.indirect) + " of the noise: not enough for the making of a cache";
    } else if (cache.integrator) {
      fits(cache);
    }
    if (photons.figures && has_unreachable_light(task_.scene)) {
      path.figures.reset();
      path.reason = "no path finds the light of point lamps and suns in mirrors and through smooth glass";
    }
    go_on(std::array{&path, &photons, &cache}, sharp);
  }

 private:
  std::int64_t scene_pixels() const { return static_cast<std::int64_t>(task_.scene.film().width) * task_.scene.film().height; }

  // Tries it out, unless it takes more memory than a method may.
  bool fits(Contender& contender) const {
    return within_memory(contender, [&] { try_out(contender); });
  }

  template <typename Work>
  static bool within_memory(Contender& contender, Work work) {
    try {
      work();
      return true;
    } catch (const ResourceError& error) {
      contender.trial.reset();
      contender.figures.reset();
      contender.reason = error.what();
      return false;
    }
  }

  void try_out(Contender& contender) const {
    PilotTrial& trial = contender.trial.emplace(task_, *contender.integrator);
    trial.advance(kTrialSamples / 2);
    const std::vector<Film> half = trial.films();
    trial.advance(kTrialSamples);
    contender.indirect = indirect_share(half, trial.films());
    measure(contender);
  }

  static void measure(Contender& contender) {
    const PilotTrial& trial = *contender.trial;
    const double unmet = contender.figures ? contender.figures->unmet_noise : 0;
    const double ray = work_of_ray(*contender.integrator);
    const bool in_levels = contender.integrator->parts().irradiance_cache;
    // Photons are shot for each sample anew, a cache is made once.
    contender.figures = {.samples = static_cast<double>(trial.samples()),
                         .noise = trial.noise(),
                         .bias = trial.bias(),
                         .unmet_noise = unmet,
                         .work_per_sample = ray * trial.rays_per_sample(),
                         .work_ahead = in_levels ? ray * trial.rays_ahead() : 0,
                         .in_levels = in_levels,
                         .seconds_per_work = trial.seconds() / (ray * trial.rays())};
  }

  // What light for photons adds to the noise of path tracing, beyond what it has met of it: by the side of the light, which does
  // not see through mirrors and glass, or by the caustics that photons see.
  double unmet(const Contender& path, const Contender& photons, double sharp) const {
    const double all = std::max(sharp, photons.trial->caustic_square(kLeftOfLamp * brightest_radiance(task_.scene)));
    return std::max(all - std::max(settled_noise(*path.figures) - settled_noise(*photons.figures), 0.0), 0.0);
  }

  // Whether photons would cost less than paths if they took away all noise by light that is scattered sharply. Over delta lobes
  // nobody knows: the side of the light does not see all of it.
  bool photons_may_gain(const Contender& path, double sharp) const {
    if (task_.scene.census().delta_lobes) return true;
    MethodTrial hoped = *path.figures;
    const double in_noise = std::min(sharp / settled_noise(*path.figures), 1.0);
    for (TileNoise& tile : hoped.noise) tile.share *= 1 - (1 - kHopedLeft) * in_noise;
    hoped.unmet_noise = 0;
    hoped.work_per_sample *= kRayWithPhotons;
    return cost_of(hoped) < cost_of(*path.figures);
  }

  // Whether a cache that takes little and works well would cost less than both. It stands on the photons, if those were tried: of
  // what paths have not met, their indirect layer says nothing.
  bool cache_may_gain(const Contender& last, const Contender& path) const {
    MethodTrial hoped = *last.figures;
    for (TileNoise& tile : hoped.noise) tile.share *= 1 - (1 - kHopedLeft) * last.indirect;
    hoped.unmet_noise = 0;
    hoped.in_levels = true;
    hoped.work_ahead = kHopedAhead * hoped.work_per_sample;
    return cost_of(hoped) < std::min(cost_of(*last.figures), cost_of(*path.figures));
  }

  double cost_of(const MethodTrial& trial) const { return cost(forecast(trial, goal_), goal_); }

  // Doubles the samples of trials, as long as that is worth it.
  void go_on(std::span<Contender* const> contenders, double sharp) const {
    while (Contender* best = cheapest(contenders)) {
      const MethodForecast expected = forecast(*best->figures, goal_);
      const std::uint32_t samples = 2 * best->trial->samples();
      if (samples > std::min<double>(most_samples(*best), kTakenAhead * expected.samples)) return;
      std::vector<Contender*> likely;
      double work = 0;  // not for the picture
      for (Contender* each : contenders) {
        if (!each->trial) continue;
        const bool goes_on = each->figures && cost_of(*each->figures) <= kStillLikely * cost(expected, goal_) &&
                             each->trial->samples() < samples && samples <= most_samples(*each);
        if (goes_on) likely.push_back(each);
        if (each == best && goal_.rel_error) continue;
        work += work_of_ray(*each->integrator) * (each->trial->rays() + (goes_on ? each->trial->rays_to_double() : 0));
      }
      if (work > kForTrials * expected.work) return;
      for (Contender* each : likely) {
        if (within_memory(*each, [&] { each->trial->advance(samples); })) measure(*each);
      }
      Contender &path = *contenders[0], &photons = *contenders[1];
      if (path.figures && photons.figures) path.figures->unmet_noise = unmet(path, photons, sharp);
    }
  }

  // Null: none has figures.
  Contender* cheapest(std::span<Contender* const> contenders) const {
    Contender* best = nullptr;
    for (Contender* each : contenders) {
      if (each->figures && (best == nullptr || cost_of(*each->figures) < cost_of(*best->figures))) best = each;
    }
    return best;
  }

  // A trial stays in a cache's first level.
  static std::uint32_t most_samples(const Contender& contender) {
    return contender.figures->in_levels ? kFirstCacheLevel : kMostTrialSamples;
  }

  const PilotTask& task_;
  const Goal& goal_;
};

Method run_pilot(const Scene& scene, const Picture& picture, int threads, const std::atomic<bool>& cancelled) {
  const auto start = std::chrono::steady_clock::now();
  std::vector<Contender> contenders;
  contenders.push_back({"path", make_integrator("path", scene), {}, {}, 0, {}});
  contenders.push_back(contender("photon-progressive", scene, "no light reaches a surface by mirrors, glass or gloss"));
  contenders.push_back(contender("irradiance-cache", scene, "no surface is diffuse"));
  const PilotTask task{scene, picture.crop, pilot_tiles(picture.crop), picture.seed, threads, cancelled};
  // Alone, path tracing needs no trial; towards an error goal its samples are the picture's, so that a forecast costs nothing.
  std::optional<LightAudit> audit;
  if (contenders[1].integrator || contenders[2].integrator || picture.goal.rel_error) {
    audit = audit_light(scene, picture.crop, picture.seed, threads, cancelled, true);
    PilotRun(task, picture.goal).run(contenders[0], contenders[1], contenders[2], *audit);
  }
  MethodChoice choice;
  choice.goal = picture.goal;
  for (const Contender& each : contenders) {
    MethodCandidate candidate{each.method, each.reason, each.figures, {}};
    if (each.figures) candidate.forecast = forecast(*each.figures, picture.goal);
    choice.candidates.push_back(std::move(candidate));
  }
  choice.candidates.push_back({"photon", "its blur stays, however many samples are taken", {}, {}});
  choose_cheapest(choice);
  Method method;
  Contender& chosen = *std::ranges::find(contenders, choice.method, &Contender::method);
  method.integrator = std::move(chosen.integrator);
  // Tiles of other goals are cut otherwise.
  if (chosen.trial) method.known = chosen.trial->take_samples(picture.goal.rel_error.has_value());
  // Of paths the audit asks more where there are mirrors or glass.
  const bool same_audit = method.integrator->finds_caustics() || !scene.census().delta_lobes;
  if (chosen.trial && audit && same_audit) method.known.keep(*std::move(audit));
  choice.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const MethodCandidate& taken = *std::ranges::find(choice.candidates, choice.method, &MethodCandidate::method);
  // Towards an error goal the pilot's samples by the chosen method are a part of both.
  const double in_both = chosen.trial && picture.goal.rel_error ? chosen.trial->seconds() : 0;
  if (taken.forecast) choice.expected_seconds = choice.seconds + std::max(taken.forecast->seconds - in_both, 0.0);
  method.choice = std::move(choice);
  return method;
}

}  // namespace

Method make_method(const std::string& name, const Scene& scene, const Picture& picture, int threads,
                   const std::atomic<bool>& cancelled) {
  if (name == "auto") return run_pilot(scene, picture, threads, cancelled);
  Method method;
  method.integrator = make_integrator(name, scene);
  return method;
}

}  // namespace fluxfarm
