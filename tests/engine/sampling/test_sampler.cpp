// Owen-scrambled Sobol points: stratification, independence of replicates, and what may change the numbers.
#include <gtest/gtest.h>

#include <set>

#include "sampling/discrete_distribution.h"
#include "sampling/pixel_filter.h"
#include "sampling/sampler.h"

namespace fluxfarm {
namespace {

// Points of replicate 0 of a pixel: samples 0, 8, 16 ...
std::vector<Vec2f> replicate_points(std::size_t count, std::uint32_t dimension, int x, std::uint64_t seed) {
  SamplerBatch sampler;
  std::array<Vec2f, kMaxSamplerBatch> u;
  for (std::uint32_t i = 0; i < count; ++i) sampler.add(seed, x, 3, kReplicates * i);
  sampler.draw_2d(dimension, u);
  return {u.begin(), u.begin() + static_cast<std::ptrdiff_t>(count)};
}

// Whether each of the 2^k boxes of size 2^-a x 2^-b, a + b = k, holds one of the first 2^k points.
bool is_net(const std::vector<Vec2f>& points, int k) {
  for (int a = 0; a <= k; ++a) {
    std::set<int> boxes;
    for (int i = 0; i < 1 << k; ++i) {
      const auto column = static_cast<int>(points[static_cast<std::size_t>(i)].x * static_cast<float>(1 << a));
      const auto row = static_cast<int>(points[static_cast<std::size_t>(i)].y * static_cast<float>(1 << (k - a)));
      boxes.insert(column << (k - a) | row);
    }
    if (boxes.size() != std::size_t{1} << k) return false;
  }
  return true;
}

TEST(Sampler, EveryPrefixOfAPowerOfTwoIsAZeroTwoNet) {
  for (const std::uint32_t dimension : {0u, 1u, 17u, 4096u}) {
    const std::vector<Vec2f> points = replicate_points(64, dimension, 5, 9);
    for (int k = 0; k <= 6; ++k) EXPECT_TRUE(is_net(points, k)) << "2^" << k << " points of dimension " << dimension;
  }
}

TEST(Sampler, TwinWithIndependentPointsIsNoNet) {
  std::vector<Vec2f> points;
  for (std::uint64_t i = 0; i < 64; ++i) {
    points.push_back(
        {to_unit_float(static_cast<std::uint32_t>(hash_words(i, 1))), to_unit_float(static_cast<std::uint32_t>(hash_words(i, 2)))});
  }
  EXPECT_FALSE(is_net(points, 6));
}

TEST(Sampler, NumbersDependOnPixelSeedReplicateAndDimensionAndOnNothingElse) {
  const auto first = [](std::uint64_t seed, int x, int y, std::uint32_t index, std::uint32_t dimension) {
    SamplerBatch sampler;
    std::array<Vec2f, kMaxSamplerBatch> u;
    sampler.add(seed, x, y, index);
    sampler.draw_2d(dimension, u);
    return u[0].x;
  };
  const float base = first(1, 2, 3, 4, 5);
  EXPECT_NE(base, first(2, 2, 3, 4, 5));
  EXPECT_NE(base, first(1, 3, 3, 4, 5));
  EXPECT_NE(base, first(1, 2, 4, 4, 5));
  EXPECT_NE(base, first(1, 2, 3, 5, 5));
  EXPECT_NE(base, first(1, 2, 3, 4, 6));
  // In company, in another place of the batch, after another was removed: the same number.
  SamplerBatch sampler;
  std::array<Vec2f, kMaxSamplerBatch> u;
  for (std::uint32_t i = 0; i < 13; ++i) sampler.add(1, 2, 3, i);
  sampler.move(4, 1);
  sampler.resize(2);
  sampler.draw_2d(5, u);
  EXPECT_EQ(base, u[1].x);
}

TEST(Sampler, ReplicatesAreUncorrelated) {
  // Correlation of the means of eight points of two replicates over many pixels: zero within four standard errors.
  const int pixels = 4000;
  double xy = 0, xx = 0, yy = 0;
  for (int pixel = 0; pixel < pixels; ++pixel) {
    SamplerBatch sampler;
    std::array<Vec2f, kMaxSamplerBatch> u;
    for (std::uint32_t i = 0; i < 64; ++i) sampler.add(7, pixel, 0, i);
    sampler.draw_2d(3, u);
    double a = 0, b = 0;
    for (std::size_t i = 0; i < 64; i += 8) {
      a += static_cast<double>(u[i].x) - 0.5;
      b += static_cast<double>(u[i + 1].x) - 0.5;
    }
    xy += a * b;
    xx += a * a;
    yy += b * b;
  }
  EXPECT_LT(std::abs(xy / std::sqrt(xx * yy)), 4 / std::sqrt(pixels));
}

TEST(Sampler, OneNumberAtATimeIsStratifiedToo) {
  SamplerBatch sampler;
  for (std::uint32_t i = 0; i < 64; ++i) sampler.add(1, 2, 3, kReplicates * i);
  std::set<int> cells;
  for (std::size_t i = 0; i < 64; ++i) cells.insert(static_cast<int>(sampler.draw_1d(11, i) * 64));
  EXPECT_EQ(cells.size(), 64u);
}

TEST(DiscreteDistribution, ChoosesInProportionAndHandsTheRestOfTheNumberOn) {
  const DiscreteDistribution d({1, 0, 3});
  EXPECT_FLOAT_EQ(d.probability(0), 0.25f);
  EXPECT_FLOAT_EQ(d.probability(1), 0);
  int counts[3] = {};
  for (int i = 0; i < 1000; ++i) {
    const auto choice = d.sample((static_cast<float>(i) + 0.5f) / 1000);
    ++counts[choice.index];
    EXPECT_GE(choice.u, 0.0f);
    EXPECT_LT(choice.u, 1.0f);
  }
  EXPECT_EQ(counts[0], 250);
  EXPECT_EQ(counts[1], 0);
  EXPECT_EQ(counts[2], 750);
}

TEST(DiscreteDistribution, NeverChoosesATrailingZero) {
  const DiscreteDistribution d({1, 2, 0});
  EXPECT_EQ(d.sample(0x1.fffffep-1f).index, 1u);
}

// The mean of x^2 of each filter, by inversion of its own density: box r^2/3, tent r^2/6.
TEST(PixelFilter, OffsetsFollowTheFilter) {
  const auto second_moment = [](const PixelFilter& filter) {
    double sum = 0;
    for (int i = 0; i < 100000; ++i) {
      const float x = filter.sample({(static_cast<float>(i) + 0.5f) / 100000, 0.5f}).x;
      sum += static_cast<double>(x) * static_cast<double>(x) / 100000;
    }
    return sum;
  };
  EXPECT_NEAR(second_moment(PixelFilter({PixelFilterKind::kBox})), 0.25 / 3, 1e-5);
  EXPECT_NEAR(second_moment(PixelFilter({PixelFilterKind::kTent})), 1.0 / 6, 1e-5);
  // Gaussian, cut at four standard deviations and lowered to zero there; the table of offsets widens it by less than 0.1 %.
  double weight = 0, moment = 0;
  for (int i = 0; i < 400000; ++i) {
    const double x = -2 + (i + 0.5) * 1e-5;
    const double g = std::exp(-2 * x * x) - std::exp(-8.0);
    weight += g;
    moment += g * x * x;
  }
  EXPECT_NEAR(second_moment(PixelFilter({PixelFilterKind::kGaussian})), moment / weight, 1e-3 * moment / weight);
}

}  // namespace
}  // namespace fluxfarm
