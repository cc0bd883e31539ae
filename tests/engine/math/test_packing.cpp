// Unit vectors and colours in 32 bits or fewer.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "math/octahedral.h"
#include "math/rgbe.h"

namespace fluxfarm {
namespace {

Vec3f random_direction(std::mt19937& random) {
  std::normal_distribution<float> normal;
  return normalize(Vec3f{normal(random), normal(random), normal(random)});
}

template <int kBits>
double worst_angle() {
  std::mt19937 random(1);
  double worst = 0;
  for (int i = 0; i < 200000; ++i) {
    const Vec3f v = random_direction(random), back = from_octahedral<kBits>(to_octahedral<kBits>(v));
    EXPECT_GT(length(back), 0.577f);
    EXPECT_LT(length(back), 1.001f);
    worst = std::max(worst, static_cast<double>(std::atan2(length(cross(v, back)), dot(v, back))));
  }
  return worst;
}

TEST(Octahedral, KeepsDirectionsToTheStatedAngle) {
  EXPECT_LT(worst_angle<16>(), 4.3 / 65534);
  EXPECT_LT(worst_angle<12>(), 4.3 / 4094);
  EXPECT_GT(worst_angle<12>(), 3.0 / 4094);  // the bound is no larger than needed
}

TEST(Octahedral, KeepsTheAxesExactly) {
  for (const Vec3f axis : {Vec3f{1, 0, 0}, Vec3f{0, -1, 0}, Vec3f{0, 0, 1}, Vec3f{0, 0, -1}, Vec3f{-1, 0, 0}, Vec3f{0, 1, 0}}) {
    EXPECT_EQ(from_octahedral<12>(to_octahedral<12>(axis)), axis);
    EXPECT_EQ(from_octahedral<16>(to_octahedral<16>(axis)), axis);
  }
}

// Mean of what is read back over what was written, of the channel of middle size.
double mean_ratio(Rgb color, bool dithered) {
  constexpr int kCount = 4096;
  double sum = 0;
  for (int i = 0; i < kCount; ++i) {
    const float dither = dithered ? (static_cast<float>(i) + 0.5f) / kCount : 0.5f;
    sum += static_cast<double>(from_rgbe(to_rgbe(color, dither)).g);
  }
  return sum / kCount / static_cast<double>(color.g);
}

TEST(Rgbe, IsRightInTheMeanWhereRoundingIsNot) {
  double worst_rounded = 0;
  for (const float scale : {1e-20f, 3e-7f, 0.9999f, 1.0f, 255.5f, 1e20f}) {
    for (const float green : {0.013f, 0.31f, 0.77f}) {
      const Rgb color{1.0f * scale, green * scale, 0};
      EXPECT_NEAR(mean_ratio(color, true), 1, 2e-4) << scale << ' ' << green;
      worst_rounded = std::max(worst_rounded, std::abs(mean_ratio(color, false) - 1));
    }
  }
  EXPECT_GT(worst_rounded, 2e-2);
}

TEST(Rgbe, StaysWithinAStepOfTheLargestChannel) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> unit(0, 0x1.fffffep-1f), exponent(-60, 60);
  for (int i = 0; i < 100000; ++i) {
    const Rgb color = Rgb{unit(random), unit(random), unit(random)} * std::exp2(exponent(random));
    const Rgb back = from_rgbe(to_rgbe(color, unit(random)));
    const float step = max_component(color) / 127;
    EXPECT_NEAR(back.r, color.r, step);
    EXPECT_NEAR(back.g, color.g, step);
    EXPECT_NEAR(back.b, color.b, step);
  }
}

TEST(Rgbe, BlackStaysBlack) {
  EXPECT_EQ(from_rgbe(to_rgbe(Rgb{}, 0.99f)), Rgb{});
  EXPECT_EQ(from_rgbe(to_rgbe(Rgb{1e-37f}, 0.99f)), Rgb{});
}

}  // namespace
}  // namespace fluxfarm
