// The environment map: Mitsuba's orientation and lookup, and directions that follow their density; with twins that must fail.
#include <gtest/gtest.h>

#include "emitters/envmap_emitter.h"
#include "support/chi_square.h"
#include "support/sky.h"

namespace fluxfarm::testing {
namespace {

// All chi-square tests of this file together reject correct code with this probability; the seeds are fixed.
constexpr double kOverallLevel = 0.01;
constexpr int kTests = 4;

// 16 columns and 10 rows of cells, whose borders are borders of the quadrature below: the density is constant in each.
const LatLongImage& sky() {
  static const LatLongImage image = patchy_sky(16, 11);
  return image;
}

// Cells about the image's own axis.
ChiSquareSettings settings() {
  ChiSquareSettings result;
  result.chart.axis = {0, 1, 0};
  return result;
}

TEST(LatLongImage, IsTurnedAsInMitsuba) {
  // Pixels that say where they are, 8 x 5; the values of Mitsuba 3.6.4's envmap.
  LatLongImage image{8, 5, {}};
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 8; ++x) image.pixels.push_back({static_cast<float>(x), static_cast<float>(y), 1});
  }
  const auto expect = [&](Vec3f direction, float column, float row) {
    const Rgb seen = image.radiance(image.cell(normalize(direction)));
    EXPECT_NEAR(seen.r, column, 1e-4f);
    EXPECT_NEAR(seen.g, row, 1e-4f);
    EXPECT_NEAR(seen.b, 1, 1e-6f);
  };
  expect({0, 0, 1}, 3.5f, 2);
  expect({1, 0, 0}, 1.5f, 2);
  expect({-1, 0, 0}, 5.5f, 2);
  expect({0, 0, -1}, 3.5f, 2);  // half of the last column and half of the first
  expect({0, 1, 0}, 3.5f, 0);
  expect({0.3f, 0.5f, 0.2f}, 2.24867f, 0.795461f);
  EXPECT_NEAR(image.radiance(image.cell({0, -1, 0})).g, 4, 1e-4f);
}

TEST(LatLongImage, DirectionsComeBackToTheirCell) {
  for (int column = 0; column < sky().width; ++column) {
    for (int row = 0; row + 1 < sky().height; ++row) {
      const double theta = (row + 0.25) * M_PI / (sky().height - 1);
      const LatLongImage::Cell cell = sky().cell(sky().direction(column, 0.75f, std::cos(theta)));
      EXPECT_EQ(cell.column, column);
      EXPECT_EQ(cell.row, row);
      EXPECT_NEAR(cell.x, 0.75f, 1e-5f);
      EXPECT_NEAR(cell.y, 0.25f, 1e-5f);
    }
  }
}

TEST(LatLongImage, DirectionThatIsNoNumberHasNoRadiance) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(is_finite(sky().radiance(sky().cell({nan, nan, nan}))));
}

TEST(LatLongDistribution, DirectionsFollowTheirDensity) {
  const LatLongDistribution distribution(sky());
  const ChiSquareResult r = chi_square(
      settings(), [&](float, Vec2f u) { return std::optional(distribution.sample(sky(), u).direction); },
      [&](Vec3f w) { return distribution.pdf(sky().cell(w)); });
  EXPECT_NEAR(r.integral, 1, 1e-5);
  EXPECT_GT(r.p_value, sidak_level(kOverallLevel, kTests));
}

TEST(LatLongDistribution, SamplesKnowTheirDensity) {
  const LatLongDistribution distribution(sky());
  for (int i = 0; i < 1000; ++i) {
    const LatLongDistribution::Sample sample =
        distribution.sample(sky(), {(static_cast<float>(i % 37) + 0.5f) / 37, (static_cast<float>(i) + 0.5f) / 1000});
    EXPECT_GT(sample.pdf_solid_angle, 0);
    EXPECT_NEAR(length(sample.direction), 1, 1e-6f);
    EXPECT_FLOAT_EQ(sample.pdf_solid_angle, distribution.pdf(sky().cell(sample.direction))) << i;
  }
}

TEST(LatLongDistributionTwin, RowsChosenWithoutTheSineAreRejected) {
  const LatLongDistribution distribution(sky());
  std::vector<double> rows;
  std::vector<DiscreteDistribution> columns;
  for (int row = 0; row + 1 < sky().height; ++row) {
    std::vector<double> weights;
    for (int column = 0; column < sky().width; ++column) weights.push_back(static_cast<double>(luminance(sky().mean(column, row))));
    columns.emplace_back(weights);
    rows.push_back(0);
    for (const double weight : weights) rows.back() += weight;
  }
  const DiscreteDistribution row_choice(rows);
  const ChiSquareResult r = chi_square(
      settings(),
      [&](float, Vec2f u) {
        const auto row = row_choice.sample(u.y);
        const auto column = columns[row.index].sample(u.x);
        const double theta = (static_cast<double>(row.index) + static_cast<double>(row.u)) * M_PI / (sky().height - 1);
        return std::optional(sky().direction(static_cast<int>(column.index), column.u, std::cos(theta)));
      },
      [&](Vec3f w) { return distribution.pdf(sky().cell(w)); });
  EXPECT_LT(r.p_value, 1e-12);
}

TEST(EnvmapEmitter, FollowsItsDensityTurnedAndMirrored) {
  for (const Transform& to_world : {Transform::rotate(0.3, 1, -0.2, 70), Transform::scale(-3, 3, 3)}) {
    const EnvmapEmitter emitter(sky(), to_world, 1);
    ChiSquareSettings turned = settings();
    // Their borders cross those of the density now: a finer quadrature.
    turned.strips = 30;
    const ChiSquareResult r = chi_square(
        turned,
        [&](float, Vec2f u) {
          const auto sample = emitter.sample({}, u);
          return sample ? std::optional(sample->wi) : std::nullopt;
        },
        [&](Vec3f w) { return emitter.from(w).pdf_solid_angle; });
    EXPECT_NEAR(r.integral, 1, 1e-3);
    EXPECT_GT(r.p_value, sidak_level(kOverallLevel, kTests));
  }
}

TEST(EnvmapEmitterTwin, TurnedTheOtherWayIsRejected) {
  const EnvmapEmitter emitter(sky(), Transform::rotate(0, 1, 0, 70), 1), other(sky(), Transform::rotate(0, 1, 0, -70), 1);
  const ChiSquareResult r = chi_square(
      settings(), [&](float, Vec2f u) { return std::optional(emitter.sample({}, u)->wi); },
      [&](Vec3f w) { return other.from(w).pdf_solid_angle; });
  EXPECT_LT(r.p_value, 1e-12);
}

TEST(EnvmapEmitter, WeightIsRadianceOverDensity) {
  const EnvmapEmitter emitter(sky(), Transform::rotate(1, 0, 0, 40), 1);
  const auto sample = emitter.sample({5, 6, 7}, {0.3f, 0.6f});
  ASSERT_TRUE(sample);
  const auto [radiance, pdf] = emitter.from(sample->wi);
  EXPECT_FLOAT_EQ(sample->pdf_solid_angle, pdf);
  EXPECT_NEAR(sample->weight.g, (radiance / pdf).g, 1e-4f);
  EXPECT_EQ(sample->distance, kDistant);
  EXPECT_FALSE(sample->delta);
}

TEST(EnvmapEmitter, BlackOneGivesNoSamples) {
  const EnvmapEmitter emitter(even_sky(0), Transform(), 1);
  EXPECT_FALSE(emitter.sample({}, {0.3f, 0.6f}));
  EXPECT_EQ(emitter.power(), Rgb{});
}

TEST(EnvmapEmitter, PowerIsThatOfTheSkyOnTheScenesSphere) {
  EXPECT_NEAR(EnvmapEmitter(even_sky(3), Transform(), 2).power().g, 4 * kPi * kPi * 4 * 3, 1e-2f);
}

TEST(EnvmapEmitter, PutsMostSamplesIntoASmallSun) {
  const LatLongImage sunny = sunny_sky();
  const EnvmapEmitter emitter(sunny, Transform(), 1);
  int bright = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto sample = emitter.sample({}, {static_cast<float>(i) / 1000, static_cast<float>(i * 617 % 1000) / 1000});
    bright += sample && sample->weight.g * sample->pdf_solid_angle > 1;
  }
  EXPECT_GT(bright, 700) << "it gives nine tenths of the light";
}

}  // namespace
}  // namespace fluxfarm::testing
