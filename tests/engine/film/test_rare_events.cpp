// Accuracy catalogue 4.9: pixels of 0.2 with noise of 0.05 and an event of probability p that is worth another 0.2 on average.
// Rules that stop each pixel by itself end with half of the light; ours may not claim an error that it does not keep.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "film/error_goal.h"
#include "film/tile_grid.h"
#include "support/failure_row.h"

namespace fluxfarm {
namespace {

using testing::percent;
using testing::tell_failure;

constexpr double kBase = 0.2, kNoise = 0.05, kEventMean = 0.2, kTruth = kBase + kEventMean;
constexpr PixelRect kCrop{0, 0, 160, 125};  // 20,000 pixels

class RarePicture {
 public:
  RarePicture(double p, std::uint64_t seed) : film(160, 125, kCrop), p_(p), random_(seed) {}

  void take(const Round& round) {
    for (const std::uint32_t tile : round.tiles) {
      TileSums sums{tiles_[tile], round.samples, 0, {}, {}, 0};
      for (int pixel = 0; pixel < sums.rect.pixels(); ++pixel) {
        for (std::uint32_t k = 0; k < sums.replicates(); ++k) {
          const double n = round.samples.size() / static_cast<double>(sums.replicates());
          std::poisson_distribution<int> events(n * p_);
          const double sum = n * kBase + std::sqrt(n) * kNoise * noise_(random_) + events(random_) * kEventMean / p_;
          sums.radiance.insert(sums.radiance.end(), 3, static_cast<float>(sum));
        }
        sums.features.insert(sums.features.end(), kFeatures, 0.0f);
      }
      film.merge(sums);
    }
  }

  // sqrt(relMSE) against the truth.
  double true_error() const {
    double sum = 0;
    for (int y = 0; y < kCrop.height; ++y) {
      for (int x = 0; x < kCrop.width; ++x) sum += std::pow(film.estimate(x, y).mean[0] - kTruth, 2) / (kTruth * kTruth + 1e-2);
    }
    return std::sqrt(sum / kCrop.pixels());
  }

  Film film;

 private:
  double p_;
  std::vector<PixelRect> tiles_ = make_tiles(kCrop, kErrorTile);
  std::mt19937_64 random_;
  std::normal_distribution<double> noise_;
};

struct Outcome {
  bool claimed;
  double true_error;
  double spp;
  std::string warning;
};

Outcome run(double p, const ErrorGoal& goal, std::uint64_t seed, const LightAudit* audit = nullptr) {
  RarePicture picture(p, seed);
  std::optional<Round> round = first_round(goal, kCrop);
  ErrorLook look;
  for (int number = 1; round; ++number) {
    picture.take(*round);
    look = look_at(picture.film, goal, number, audit);
    round = look.next;
  }
  return {look.bound <= goal.rel_error, picture.true_error(), picture.film.summary().mean_samples, look.warning};
}

// An audit that knows the truth to a percent.
LightAudit truth_seen_by_light() {
  LightAudit audit;
  audit.cells.assign(make_tiles(kCrop, kErrorTile).size(), {kTruth, std::pow(0.01 * kTruth, 2), 0, 0});
  return audit;
}

std::string row_of(double p) { return "rare event, 1 in " + std::to_string(std::lround(1 / p)); }

class RareEventsMet : public ::testing::TestWithParam<double> {};

// Eight pictures: with a coverage of 95 % three or more would miss the goal once in 170 runs.
TEST_P(RareEventsMet, AreSampledUntilTheClaimHolds) {
  const ErrorGoal goal{0.1};
  int missed = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const Outcome outcome = run(GetParam(), goal, seed);
    EXPECT_TRUE(outcome.claimed);
    missed += outcome.true_error > goal.rel_error;
    if (seed != 1) continue;
    tell_failure(row_of(GetParam()), "on",
                 "claims 10 % with a true error of " + percent(outcome.true_error, "%.1f %%") + " after " +
                     std::to_string(std::lround(outcome.spp)) + " samples a pixel");
  }
  EXPECT_LE(missed, 2);
}
INSTANTIATE_TEST_SUITE_P(Catalogue49, RareEventsMet, ::testing::Values(1.0 / 200, 1.0 / 2000, 1.0 / 20000));

// An event that nothing of the picture has met: its samples agree with each other, and only the side of the light knows better.
TEST(RareEvents, NeverMetAreNotClaimedAgainstTheAudit) {
  const ErrorGoal goal{0.1, 8192};
  const LightAudit audit = truth_seen_by_light();
  const Outcome outcome = run(1e-9, goal, 1, &audit);
  EXPECT_FALSE(outcome.claimed);
  EXPECT_EQ(outcome.spp, 4096) << "the tiles in doubt are tried for long, not for ever";
  EXPECT_NE(outcome.warning.find("finds too rarely"), std::string::npos) << outcome.warning;
  EXPECT_NE(outcome.warning.find("50 %"), std::string::npos) << outcome.warning;
  // Twin: without the audit half of the light is missing and the goal is claimed.
  const Outcome blind = run(1e-9, goal, 1);
  EXPECT_TRUE(blind.claimed);
  EXPECT_GT(blind.true_error, 0.4);
  tell_failure("event never met", "off", "claims 10 % with a true error of " + percent(blind.true_error, "%.0f %%"));
  tell_failure("event never met", "on", "\"" + outcome.warning + "\"");
}

TEST(RareEvents, ThatWereMetSatisfyTheAudit) {
  const ErrorGoal goal{0.1};
  const LightAudit audit = truth_seen_by_light();
  const Outcome outcome = run(1.0 / 200, goal, 1, &audit);
  EXPECT_TRUE(outcome.claimed) << outcome.warning;
  EXPECT_LE(outcome.true_error, goal.rel_error);
}

// Many shards of one pixel, each ended by a Z-test of 5 % at 95 % that looks every 16 samples from 64 on.
struct Merged {
  double mean_of_means = 0, sum_over_sum = 0;  // over the truth
};

Merged merge_stopped_shards(double p, int shards) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise;
  std::binomial_distribution<int> events(16, p);
  double means = 0, all = 0, taken = 0;
  for (int shard = 0; shard < shards; ++shard) {
    double sum = 0, squares = 0, n = 0;
    for (bool stopped = false; !stopped;) {
      const int met = events(random);
      const double event = kEventMean / p;
      sum += met * event;
      squares += met * event * (event + 2 * kBase);
      // The noise of 16 samples; later, when events rule, their sum of squares is taken at its mean.
      for (int i = 0; n < 512 && i < 16; ++i) {
        const double x = kBase + kNoise * noise(random);
        sum += x;
        squares += x * x;
      }
      if (n >= 512) {
        sum += 16 * kBase + 4 * kNoise * noise(random);
        squares += 16 * (kBase * kBase + kNoise * kNoise);
      }
      n += 16;
      const double mean = sum / n, variance = (squares / n - mean * mean) / n;
      stopped = n >= 64 && 1.959964 * std::sqrt(variance) <= 0.05 * mean;
    }
    means += sum / n;
    all += sum;
    taken += n;
  }
  return {means / shards / kTruth, all / taken / kTruth};
}

// The film keeps sums and counts. Its twin, the mean of means, loses 30 % of the light.
TEST(RareEvents, SumsOverSumsKeepTheTruthThatMeansOfMeansLose) {
  const Merged merged = merge_stopped_shards(1.0 / 200, 4000);
  EXPECT_NEAR(merged.sum_over_sum, 1.0, 0.005);
  EXPECT_NEAR(merged.mean_of_means, 0.698, 0.02);
  for (const double p : {1.0 / 200, 1.0 / 2000, 1.0 / 20000}) {
    const double stopped_early = merge_stopped_shards(p, 4000).mean_of_means - 1;
    tell_failure(row_of(p), "off", percent(stopped_early) + " where each pixel ends by a Z-test");
  }
  tell_failure("merged shards", "off", percent(merged.mean_of_means - 1) + " by a mean of means");
  tell_failure("merged shards", "on", percent(merged.sum_over_sum - 1) + " by sums over sums");
}

}  // namespace
}  // namespace fluxfarm
