// Free flight in a homogeneous medium and its three channels.
#include <gtest/gtest.h>

#include <random>

#include "media/channel_mis.h"
#include "media/homogeneous_medium.h"

namespace fluxfarm::testing {
namespace {

const HomogeneousMedium kColoured({{0.5f, 2.0f, 9.0f}, {1.0f, 0.9f, 0.4f}, 0.3f});

TEST(HomogeneousMedium, TransmittanceIsBeersLaw) {
  const Rgb left = kColoured.transmittance(0.75f);
  EXPECT_FLOAT_EQ(left.r, std::exp(-0.375f));
  EXPECT_FLOAT_EQ(left.g, std::exp(-1.5f));
  EXPECT_FLOAT_EQ(left.b, std::exp(-6.75f));
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(kColoured.transmittance(infinity), Rgb(0.0f));
  EXPECT_EQ(HomogeneousMedium({{0, 1, 0}, {}, 0}).transmittance(infinity), Rgb(1, 0, 1));
}

// Kolmogorov and Smirnov's distance on a grid of u is that of the grid; a wrong extinction is far outside.
TEST(HomogeneousMedium, DistancesAreExponential) {
  constexpr int kSteps = 1000;
  double worst = 0, worst_of_twin = 0;
  for (int i = 0; i < kSteps; ++i) {
    const float u = (static_cast<float>(i) + 0.5f) / kSteps;
    const double t = kColoured.sample_distance(1, u);
    worst = std::max(worst, std::abs(1 - std::exp(-2 * t) - static_cast<double>(u)));
    worst_of_twin = std::max(worst_of_twin, std::abs(1 - std::exp(-2 * 1.02 * t) - static_cast<double>(u)));
  }
  EXPECT_LT(worst, 1e-6);
  EXPECT_GT(worst_of_twin, 5e-3);
  EXPECT_TRUE(std::isinf(HomogeneousMedium({{0, 1, 0}, {}, 0}).sample_distance(0, 0.5f)));
  EXPECT_TRUE(std::isfinite(kColoured.sample_distance(2, 0x1.fffffep-1f)));
}

// The weight times the mean over the channels of the density of having chosen the path is what light does along it.
TEST(ChannelMis, WeightTimesMeanDensityIsTheContributionOfThePath) {
  const HomogeneousMedium other({{3.0f, 0.0f, 1.0f}, {0.5f, 0.5f, 0.5f}, 0});
  ChannelMis channels;
  Rgb weight = channels.scatter(kColoured, 0.4f);
  weight *= channels.pass(other, 0.7f);
  weight *= channels.scatter(kColoured, 0.1f);
  const Rgb density = kColoured.sigma_t() * kColoured.transmittance(0.4f) * other.transmittance(0.7f) * kColoured.sigma_t() *
                      kColoured.transmittance(0.1f);
  const Rgb contribution = kColoured.sigma_s() * kColoured.transmittance(0.4f) * other.transmittance(0.7f) * kColoured.sigma_s() *
                           kColoured.transmittance(0.1f);
  const Rgb product = weight * mean(density);
  EXPECT_NEAR(product.r / contribution.r, 1, 1e-5);
  EXPECT_NEAR(product.g / contribution.g, 1, 1e-5);
  EXPECT_NEAR(product.b / contribution.b, 1, 1e-5);
}

TEST(ChannelMis, NoColourWeighsMoreThanThreeTimesHoweverOftenThePathScatters) {
  const HomogeneousMedium white({{1.0f, 4.0f, 12.0f}, Rgb{1.0f}, 0});
  std::mt19937 generator(3);
  for (int path = 0; path < 100; ++path) {
    ChannelMis channels;
    Rgb weight{1.0f};
    for (int i = 0; i < 1000; ++i) {
      weight *= channels.scatter(white, white.sample_distance(path % 3, static_cast<float>(generator() >> 8) * 0x1p-24f));
    }
    EXPECT_LE(max_component(weight), 3.001f);
    EXPECT_TRUE(is_finite(weight));
  }
}

TEST(ChannelMis, GreyMediaNeedNoWeights) {
  ChannelMis channels;
  const HomogeneousMedium grey({Rgb{7.0f}, Rgb{0.8f}, 0});
  EXPECT_EQ(channels.pass(grey, 100), Rgb(1.0f));
  EXPECT_FLOAT_EQ(channels.scatter(grey, 3).g, 0.8f);
}

TEST(ChannelMis, EscapesToInfinityWhereNothingCollides) {
  ChannelMis channels;
  const Rgb weight = channels.pass(HomogeneousMedium({{0, 1, 0}, {}, 0}), std::numeric_limits<float>::infinity());
  EXPECT_FLOAT_EQ(weight.r, 1.5f);  // two of three channels could have chosen it
  EXPECT_EQ(weight.g, 0);
}

}  // namespace
}  // namespace fluxfarm::testing
