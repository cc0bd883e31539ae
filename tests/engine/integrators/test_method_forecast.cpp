// What a trial foretells of a method, and which one is taken.
#include <gtest/gtest.h>

#include <cmath>

#include "integrators/plan/method_choice.h"
#include "integrators/plan/method_forecast.h"

namespace fluxfarm {
namespace {

constexpr int kPixels = 1024;  // of a tile

MethodTrial trial(double noise, double work_per_sample) {
  return {
      .samples = 16, .noise = {{noise, kPixels}, {noise, kPixels}}, .work_per_sample = work_per_sample, .seconds_per_work = 1e-6};
}

TEST(MethodForecast, FourTimesTheSamplesHalveTheErrorOrALittleMore) {
  const MethodTrial even = trial(0.04, 1000);
  const double ratio = forecast_samples(even, 100).error / forecast_samples(even, 400).error;
  EXPECT_GE(ratio, 2);
  EXPECT_LE(ratio, 2.4);
  EXPECT_EQ(forecast_samples(even, 16).error, 0.2);  // the trial's own
  EXPECT_EQ(forecast_samples(even, 100).work, 100'000);
  EXPECT_DOUBLE_EQ(forecast_samples(even, 100).seconds, 0.1);
}

TEST(MethodForecast, AnErrorGoalTakesTheFirstRoundAtLeastAndMoreForLess) {
  const MethodTrial even = trial(0.04, 1000);
  EXPECT_EQ(forecast(even, {{}, {}, 0.5}).samples, 16);
  const MethodForecast coarse = forecast(even, {{}, {}, 0.1}), fine = forecast(even, {{}, {}, 0.05});
  EXPECT_LE(coarse.error, 0.1);
  EXPECT_GT(fine.samples, 3 * coarse.samples);
  EXPECT_LT(fine.samples, 5 * coarse.samples);
}

TEST(MethodForecast, MoreOfTheSameTrialForetellsTheSame) {
  MethodTrial longer = trial(0.04, 1000);
  longer.samples = 64;
  for (TileNoise& tile : longer.noise) tile.share = std::pow(forecast_samples(trial(0.04, 1000), 64).error, 2);
  EXPECT_NEAR(forecast_samples(longer, 1000).error, forecast_samples(trial(0.04, 1000), 1000).error, 1e-6);
  EXPECT_NEAR(settled_noise(longer), settled_noise(trial(0.04, 1000)), 1e-6);
}

TEST(MethodForecast, NoiseInOneTileTakesFewerSamplesThanTheSameNoiseInAll) {
  MethodTrial uneven = trial(0, 1000);
  uneven.noise = {{0.16, kPixels}, {0, 3 * kPixels}};
  const Goal goal{{}, {}, 0.05};
  EXPECT_LT(forecast(uneven, goal).samples, 0.5 * forecast(trial(0.04, 1000), goal).samples);
}

TEST(MethodForecast, EachLevelOfACacheCostsMoreAndLeavesLessBias) {
  MethodTrial cache = trial(0, 1);
  cache.bias = 0.01;
  cache.work_ahead = 1000;
  cache.in_levels = true;
  const MethodForecast first = forecast_samples(cache, 16), second = forecast_samples(cache, 128),
                       third = forecast_samples(cache, 129);
  EXPECT_EQ(first.work, 1016);
  EXPECT_GT(second.work, 2 * first.work);
  EXPECT_GT(third.work, 1.5 * second.work);
  EXPECT_LT(second.error, 0.7 * first.error);
}

TEST(MethodForecast, ASliverOfATileWeighsAsMuchAsItsPixels) {
  MethodTrial slivers = trial(0.04, 1000);
  slivers.noise.push_back({40, 1});
  EXPECT_NEAR(mean_noise(slivers), 0.04 + 40.0 / 2049, 1e-3);
}

TEST(MethodForecast, BlurOfPhotonsFalls) {
  MethodTrial photons = trial(0, 1);
  photons.bias = 0.01;
  EXPECT_NEAR(forecast_samples(photons, 64 * photons.samples).error, 0.1 / 4, 1e-6);
}

TEST(MethodForecast, AGoalInSecondsIsOneInRaysSoThatNoClockDecides) {
  const Goal goal{{}, 0.5, {}};
  MethodTrial slow = trial(0.04, 1000);
  const double samples = forecast(slow, goal).samples;
  EXPECT_GT(samples, 100);
  slow.seconds_per_work = 1;
  EXPECT_EQ(forecast(slow, goal).samples, samples);
  slow.work_per_sample = 2000;
  EXPECT_NEAR(forecast(slow, goal).samples, samples / 2, 0.1 * samples);
}

MethodChoice choose(const Goal& goal, const MethodTrial& a, const MethodTrial& b) {
  MethodChoice choice;
  choice.goal = goal;
  choice.candidates = {{"a", "", a, forecast(a, goal)}, {"b", "", b, forecast(b, goal)}, {"c", "does not suit", {}, {}}};
  choose_cheapest(choice);
  return choice;
}

TEST(MethodChoice, TakesWhatNeedsTheLeastWorkForTheGoal) {
  const MethodTrial quick = trial(0.04, 1000), good = trial(0.01, 2000);
  const MethodChoice fine = choose({{}, {}, 0.01}, quick, good);
  EXPECT_EQ(fine.method, "b");
  EXPECT_NE(fine.reason.find("least work until a relative error of 0.01: a has 1."), std::string::npos) << fine.reason;
  EXPECT_EQ(choose({{}, {}, 0.2}, quick, good).method, "a");  // both are done after the first round
  EXPECT_EQ(choose({256, {}, {}}, quick, good).method, "b");
  EXPECT_EQ(choose({{}, 1.0, {}}, quick, good).method, "b");
}

TEST(MethodChoice, LightThatATrialDidNotMeetCounts) {
  MethodTrial blind = trial(0.01, 1000);
  EXPECT_EQ(choose({{}, {}, 0.05}, blind, trial(0.04, 1000)).method, "a");
  blind.unmet_noise = 16;
  EXPECT_EQ(choose({{}, {}, 0.05}, blind, trial(0.04, 1000)).method, "b");
}

// What is done by the first round at once, but only just, is not taken over what surely is for a little more.
TEST(MethodChoice, TwiceTheNoiseCountsAsMuchAsWhatATrialShows) {
  const MethodTrial hardly = trial(0.0015, 1000), surely = trial(0.0001, 1200);
  const Goal goal{{}, {}, 0.05};
  EXPECT_LT(forecast(hardly, goal).work, forecast(surely, goal).work);
  EXPECT_EQ(choose(goal, hardly, surely).method, "b");
}

TEST(MethodChoice, AGoalOutOfReachIsNotTheCheapestOne) {
  MethodTrial never = trial(0.04, 1);
  never.unmet_noise = 1e9;
  const MethodTrial slow = trial(0.04, 1e6);
  EXPECT_LT(forecast(never, {{}, {}, 0.01}).work, forecast(slow, {{}, {}, 0.01}).work);
  EXPECT_EQ(choose({{}, {}, 0.01}, never, slow).method, "b");
}

TEST(MethodChoice, SaysSoWhereNothingHasNoise) {
  const MethodChoice black = choose({64, {}, {}}, trial(0, 1), trial(0, 2));
  EXPECT_EQ(black.reason, "nothing that was tried has any noise");
}

TEST(MethodChoice, TakesTheFirstMethodWhereNoneWasTried) {
  MethodChoice choice;
  choice.candidates = {{"path", "", {}, {}}, {"b", "does not suit", {}, {}}};
  choose_cheapest(choice);
  EXPECT_EQ(choice.method, "path");
  EXPECT_EQ(choice.reason, "no other method suits the scene");
}

}  // namespace
}  // namespace fluxfarm
