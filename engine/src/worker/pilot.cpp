#include "worker/pilot.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "film/error_goal.h"
#include "integrators/plan/method_forecast.h"
#include "support/error.h"
#include "worker/pilot_trial.h"

namespace fluxfarm {
namespace {

// Time of a ray of a method over that of one of path tracing, with all that is done about it; measured on our scenes with 8 to 129
// samples (engine/docs/decisions/0012): photons 1.3 to 1.9, caches 1.2 to 1.7, with photons 1.7 to 2.5.
constexpr double kRayWithPhotons = 1.6, kRayWithCache = 1.5, kRayWithBoth = 2.3;

// What is left of noise after the first round: more than half is gone, as few samples let it look larger than it is. Path tracing
// on seven of our scenes: 0.22 to 0.5.
constexpr double kLeftAfterFirstRound = 0.37;

// Before a cache is tried: what its first level may take, in samples of path tracing, and how much of the indirect light's noise
// it may leave, at best.
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
  double indirect = 0;  // part of its noise in the indirect layer
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

class PilotRun {
 public:
  PilotRun(const PilotTask& task, const Goal& goal) : task_(task), goal_(goal) {}

  void run(Contender& path, Contender& photons, Contender& cache) const {
    try_out(path);
    if (photons.integrator && fits(photons)) path.figures->unmet_noise = unmet_caustic(path, photons);
    const Contender& last = photons.figures ? photons : path;
    if (cache.integrator && scene_pixels() > kMostPixelsOfACache) {
      cache.reason = "the frame has more than " + std::to_string(kMostPixelsOfACache) + " pixels";
    } else if (cache.integrator && !(may_gain(path) && may_gain(last))) {
      cache.reason = "indirect light makes " + percent(last.indirect) + " of the noise: not enough for the making of a cache";
    } else if (cache.integrator && fits(cache)) {
      cache.figures->in_levels = true;
    }
    if (photons.figures && has_unreachable_light(task_.scene)) {
      path.figures.reset();
      path.reason = "no path finds the light of point lamps and suns in mirrors and through smooth glass";
    }
  }

 private:
  std::int64_t scene_pixels() const { return static_cast<std::int64_t>(task_.scene.film().width) * task_.scene.film().height; }

  // Tries it out, unless it takes more memory than a method may.
  bool fits(Contender& contender) const {
    try {
      try_out(contender);
      return true;
    } catch (const ResourceError& error) {
      contender.trial.reset();
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
    const double ray = work_of_ray(*contender.integrator);
    MethodTrial& figures = contender.figures.emplace(MethodTrial{trial.noise(), 0, trial.bias(), 0, 0, false, 0});
    for (TileNoise& tile : figures.noise) tile.share *= kLeftAfterFirstRound;
    figures.work_per_sample = ray * trial.rays_per_sample();
    // Photons are shot for each sample anew, a cache is made once.
    figures.work_ahead = contender.integrator->parts().irradiance_cache ? ray * trial.rays_ahead() : 0;
    figures.seconds_per_work = trial.seconds() / (ray * trial.rays());
  }

  // What caustics that photons see add to the noise of path tracing, beyond what it has met of them.
  double unmet_caustic(const Contender& path, const Contender& photons) const {
    const double brightness = kLeftOfLamp * brightest_radiance(task_.scene);
    const double all = photons.trial->caustic_noise(brightness) * kTrialSamples / kFirstRound;
    const double met = std::max(mean_noise(*path.figures) - mean_noise(*photons.figures), 0.0);
    return std::max(all - met, 0.0);
  }

  // Whether a cache that takes little and works well would cost less than that method.
  bool may_gain(const Contender& than) const {
    MethodTrial hoped = *than.figures;
    for (TileNoise& tile : hoped.noise) tile.share *= 1 - (1 - kHopedLeft) * than.indirect;
    hoped.unmet_noise = 0;
    hoped.in_levels = true;
    hoped.work_ahead = kHopedAhead * hoped.work_per_sample;
    return cost(forecast(hoped, goal_), goal_) < cost(forecast(*than.figures, goal_), goal_);
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
  if (contenders[1].integrator || contenders[2].integrator || picture.goal.rel_error) {
    PilotRun(task, picture.goal).run(contenders[0], contenders[1], contenders[2]);
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
