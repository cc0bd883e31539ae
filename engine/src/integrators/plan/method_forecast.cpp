// [Neyman34] J. Neyman, "On the Two Different Aspects of the Representative Method", J. R. Statist. Soc. 97(4), 1934.
#include "integrators/plan/method_forecast.h"

#include <algorithm>
#include <cmath>

#include "film/error_goal.h"
#include "integrators/irradiance/cache_quality.h"

namespace fluxfarm {
namespace {

// relMSE by noise falls as samples^-kFirstFall, as samples are stratified and few of them let it look larger than it is, and after
// so many as samples^-kLaterFall. By the blur of photons it falls as samples^-kBlurFall.
constexpr double kFirstFall = 1.25, kLaterFall = 1.1, kSettled = 128, kBlurFall = 2.0 / 3;

// What the bound of an error goal and rounds that double samples add: a picture is done when its error is so much below its goal.
constexpr double kMargin = 0.8;

// Of the next level of a cache over the one before: the squared bias that it leaves.
constexpr double kBiasLeft = 1 / 3.7;

// Rays of path tracing that a second is taken for: two threads trace 6 to 14 millions in our scenes.
constexpr double kWorkOfSecond = 1e7;

double fallen(double samples) {
  return std::pow(std::min(samples, kSettled), -kFirstFall) * std::pow(std::max(samples / kSettled, 1.0), -kLaterFall);
}

struct Levels {
  double work = 0, bias = 1;  // over those of the first
};

Levels levels(double samples) {
  Levels all{1, 1};
  double next = kSecondLevelGrowth;
  for (double end = kFirstCacheLevel; samples > end; end *= 8) {
    all.work += next;
    all.bias *= kBiasLeft;
    next *= kNextLevelGrowth;
  }
  return all;
}

// Where tiles take samples in proportion to their standard deviations, the noise that equal samples would leave falls to this
// part of it, beyond the first round.                                                                        [Neyman34]
double spread_gain(const MethodTrial& trial) {
  double deviations = 0, pixels = 0;
  for (const TileNoise& tile : trial.noise) {
    deviations += tile.pixels * std::sqrt(tile.share);
    pixels += tile.pixels;
  }
  deviations /= pixels;
  const double all = mean_noise(trial);
  return all > 0 ? deviations * deviations / all : 1;
}

MethodForecast forecast_spread(const MethodTrial& trial, double samples, double gain) {
  const double blur = std::pow(trial.samples / std::max(samples, trial.samples), kBlurFall);
  const Levels level = trial.in_levels ? levels(samples) : Levels{1, blur};
  const double noise = mean_noise(trial) * gain * fallen(samples) / fallen(trial.samples) + trial.unmet_noise / samples;
  MethodForecast result;
  result.samples = samples;
  result.error = std::sqrt(noise + trial.bias * level.bias);
  result.work = trial.work_ahead * level.work + trial.work_per_sample * samples;
  result.seconds = result.work * trial.seconds_per_work;
  return result;
}

// Until a goal in seconds or in error. Samples go up by tenths until the goal, or the time, is met.
MethodForecast forecast_goal(const MethodTrial& trial, const Goal& goal) {
  const double gain = goal.rel_error ? spread_gain(trial) : 1;
  MethodForecast result = forecast_spread(trial, goal.rel_error ? kFirstRound : 1, 1);
  for (double samples = result.samples; samples < kMostForecast; samples *= 1.1) {
    const MethodForecast next = forecast_spread(trial, samples, samples > kFirstRound ? gain : 1);
    if (goal.seconds && next.work > *goal.seconds * kWorkOfSecond) break;
    result = next;
    if (goal.rel_error && reaches(result, goal)) break;
  }
  return result;
}

}  // namespace

double mean_noise(const MethodTrial& trial) {
  double sum = 0, pixels = 0;
  for (const TileNoise& tile : trial.noise) {
    sum += tile.pixels * tile.share;
    pixels += tile.pixels;
  }
  return sum / pixels;
}

double settled_noise(const MethodTrial& trial) { return mean_noise(trial) * fallen(kSettled) / fallen(trial.samples) * kSettled; }

MethodForecast forecast_samples(const MethodTrial& trial, double samples) { return forecast_spread(trial, samples, 1); }

MethodForecast forecast(const MethodTrial& trial, const Goal& goal) {
  if (goal.spp) return forecast_samples(trial, *goal.spp);
  MethodForecast result = forecast_goal(trial, goal);
  if (!goal.rel_error) return result;
  MethodTrial noisier = trial;
  for (TileNoise& tile : noisier.noise) tile.share *= 2;
  noisier.unmet_noise *= 2;
  result.work_in_doubt = forecast_goal(noisier, goal).work;
  return result;
}

bool reaches(const MethodForecast& forecast, const Goal& goal) {
  return !goal.rel_error || forecast.error <= kMargin * *goal.rel_error;
}

}  // namespace fluxfarm
