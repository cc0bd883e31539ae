// The phase function: samples follow the value, which integrates to one and has the mean cosine g.
//
// Chi-square at an overall level of 1e-4 over all cases (Sidak), each with a twin that is wrong by little and must fail.
#include <gtest/gtest.h>

#include "media/phase_function.h"
#include "support/chi_square.h"

namespace fluxfarm::testing {
namespace {

constexpr float kAsymmetries[] = {-0.95f, -0.4f, 0.0f, 1e-4f, 0.5f, 0.9f, 0.99f};
constexpr double kOverallLevel = 1e-4;
const Vec3f kAlong = normalize(Vec3f{0.3f, -0.5f, 0.8f});

// Cells gathered where the function peaks: around the direction of flight, or against it.
ChiSquareSettings settings_for(float g) {
  ChiSquareSettings settings;
  settings.chart.axis = g < 0 ? -kAlong : kAlong;
  settings.chart.power = std::abs(g) > 0.98f ? 5 : std::abs(g) > 0.8f ? 3 : 1;
  settings.strips = 8;
  return settings;
}

ChiSquareResult test_against(float g, float claimed) {
  const PhaseFunction phase(g), claim(claimed);
  return chi_square(
      settings_for(g), [&](float, Vec2f u) -> std::optional<Vec3f> { return phase.sample(kAlong, u); },
      [&](Vec3f out) -> double { return claim.value(kAlong, out); });
}

TEST(PhaseFunctionSampling, SamplesFollowTheValueWhichIntegratesToOne) {
  for (const float g : kAsymmetries) {
    SCOPED_TRACE(g);
    const ChiSquareResult r = test_against(g, g);
    EXPECT_GT(r.p_value, sidak_level(kOverallLevel, static_cast<int>(std::size(kAsymmetries))));
    EXPECT_NEAR(r.integral, 1, 1e-4);
    EXPECT_EQ(r.success_fraction, 1);
  }
}

TEST(PhaseFunctionSampling, TwinsWithAWrongAsymmetryAreRejected) {
  for (const float g : {-0.4f, 0.5f, 0.9f}) {
    EXPECT_LT(test_against(g, g + 0.02f).p_value, 1e-6) << g;
    EXPECT_LT(test_against(g, -g).p_value, 1e-6) << g << ": forwards and backwards swapped";
  }
}

TEST(PhaseFunctionSampling, MeanCosineIsTheAsymmetry) {
  for (const float g : kAsymmetries) {
    const PhaseFunction phase(g);
    // By quadrature of the value over cells, whose own cosines are weighted in.
    ChiSquareSettings settings = settings_for(g);
    double mean = 0;
    for (const double cell :
         integrate_cells(settings, [&](Vec3f out) -> double { return phase.value(kAlong, out) * dot(kAlong, out); })) {
      mean += cell;
    }
    EXPECT_NEAR(mean, g, 2e-4);
    // By samples on a grid, which stratifies them.
    double sampled = 0;
    constexpr int kSide = 256;
    for (int i = 0; i < kSide * kSide; ++i) {
      const Vec2f u{(static_cast<float>(i % kSide) + 0.5f) / kSide, (static_cast<float>(i / kSide) + 0.5f) / kSide};
      sampled += static_cast<double>(dot(kAlong, phase.sample(kAlong, u))) / (kSide * kSide);
    }
    EXPECT_NEAR(sampled, g, 4e-3);  // the grid misses the rare turns of a sharp peak
  }
}

TEST(PhaseFunctionValue, IsHenyeyAndGreensteins) {
  for (const double g : {-0.7, 0.0, 0.3, 0.99}) {
    for (const double cosine : {-1.0, -0.2, 0.6, 1.0}) {
      const double expected = (1 - g * g) / (4 * M_PI * std::pow(1 + g * g - 2 * g * cosine, 1.5));
      const Vec3f out{static_cast<float>(std::sqrt(1 - cosine * cosine)), 0, static_cast<float>(cosine)};
      EXPECT_NEAR(static_cast<double>(PhaseFunction(static_cast<float>(g)).value({0, 0, 1}, out)) / expected, 1, 2e-4);
    }
  }
}

TEST(PhaseFunctionValue, IsReciprocal) {
  const PhaseFunction phase(0.6f);
  const Vec3f out = normalize(Vec3f{0.1f, 0.9f, -0.2f});
  EXPECT_FLOAT_EQ(phase.value(kAlong, out), phase.value(-out, -kAlong));
}

}  // namespace
}  // namespace fluxfarm::testing
