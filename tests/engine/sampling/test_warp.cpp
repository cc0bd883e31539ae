// Every warp against its density: chi-square on the sphere, on the disk and on the triangle, and twins that must fail.
#include <gtest/gtest.h>

#include "sampling/warp.h"
#include "support/chi_square.h"

namespace fluxfarm::testing {
namespace {

// All chi-square tests of this file together reject correct code with this probability; the seeds are fixed.
constexpr double kOverallLevel = 0.01;
constexpr int kTests = 8;

template <class Warp, class Density>
ChiSquareResult test_directions(Warp warp, Density density) {
  return chi_square(
      {}, [&](float, Vec2f u) { return std::optional(warp(u)); }, density);
}

void expect_accepted(const ChiSquareResult& r, double quadrature_error = 1e-4) {
  EXPECT_GT(r.p_value, sidak_level(kOverallLevel, kTests));
  EXPECT_NEAR(r.integral, 1, quadrature_error);
}

TEST(Warp, DirectionsFollowTheirDensities) {
  expect_accepted(test_directions(square_to_cosine_hemisphere, square_to_cosine_hemisphere_pdf));
  expect_accepted(test_directions(square_to_uniform_hemisphere, square_to_uniform_hemisphere_pdf));
  expect_accepted(test_directions(square_to_uniform_sphere, square_to_uniform_sphere_pdf));
}

TEST(Warp, ConesFollowTheirDensities) {
  // Rims on borders of the cells, where the quadrature is exact: theta = k pi / 20.
  for (const double theta : {2 * std::numbers::pi / 20, 5 * std::numbers::pi / 20, 13 * std::numbers::pi / 20}) {
    const float cos_max = static_cast<float>(std::cos(theta));
    ChiSquareSettings settings;
    const ChiSquareResult r = chi_square(
        settings, [&](float, Vec2f u) { return std::optional(square_to_uniform_cone(u, cos_max)); },
        [&](Vec3f w) { return square_to_uniform_cone_pdf(w, cos_max); });
    expect_accepted(r);
  }
}

// Plane figures: the unit square [-1,1]^2 or [0,1]^2 cut into cells, expected counts by a fine midpoint rule.
template <class Warp, class Density>
double plane_p_value(Warp warp, Density density, double low) {
  constexpr int kCells = 24, kFine = 40, kSamples = 200000;
  const double width = (1 - low) / kCells, fine = width / kFine;
  std::vector<std::pair<double, double>> cells(kCells * kCells);
  for (int i = 0; i < kCells * kFine; ++i) {
    for (int j = 0; j < kCells * kFine; ++j) {
      const Vec2f p{static_cast<float>(low + (i + 0.5) * fine), static_cast<float>(low + (j + 0.5) * fine)};
      cells[static_cast<std::size_t>(i / kFine * kCells + j / kFine)].first += density(p) * fine * fine * kSamples;
    }
  }
  std::mt19937 generator(5);
  const auto uniform = [&] { return static_cast<float>(generator() >> 8) * 0x1p-24f; };
  for (int i = 0; i < kSamples; ++i) {
    const float x = uniform(), y = uniform();
    const Vec2f p = warp({x, y});
    const int column = std::clamp(static_cast<int>((p.x - low) / width), 0, kCells - 1);
    const int row = std::clamp(static_cast<int>((p.y - low) / width), 0, kCells - 1);
    cells[static_cast<std::size_t>(column * kCells + row)].second += 1;
  }
  return pearson_p_value(std::move(cells));
}

TEST(Warp, DiskIsUniform) {
  EXPECT_GT(plane_p_value(square_to_uniform_disk, square_to_uniform_disk_pdf, -1), sidak_level(kOverallLevel, kTests));
}

TEST(Warp, TriangleIsUniform) {
  EXPECT_GT(plane_p_value(square_to_uniform_triangle, square_to_uniform_triangle_pdf, 0), sidak_level(kOverallLevel, kTests));
}

TEST(Warp, DirectionsHaveUnitLengthAtTheEndsOfTheSquare) {
  const float ends[] = {0.0f, 1e-7f, 0.25f, 0.5f, 0.75f, 1 - 0x1p-24f};
  for (const float x : ends) {
    for (const float y : ends) {
      EXPECT_NEAR(length(square_to_cosine_hemisphere({x, y})), 1, 1e-6);
      EXPECT_NEAR(length(square_to_uniform_sphere({x, y})), 1, 1e-6);
      EXPECT_NEAR(length(square_to_uniform_cone({x, y}, 0.999f)), 1, 1e-6);
      EXPECT_GE(square_to_uniform_hemisphere({x, y}).z, 0);
      const Vec2f b = square_to_uniform_triangle({x, y});
      EXPECT_TRUE(b.x >= 0 && b.y >= 0 && b.x + b.y <= 1);
    }
  }
}

TEST(Warp, SinCosOfAnOctantIsGoodToSinglePrecision) {
  for (int i = -1000; i <= 1000; ++i) {
    const float angle = kPi / 4 * static_cast<float>(i) / 1000;
    const SinCos a = sin_cos_octant(angle);
    EXPECT_NEAR(a.sin, std::sin(static_cast<double>(angle)), 1.2e-7);
    EXPECT_NEAR(a.cos, std::cos(static_cast<double>(angle)), 1.2e-7);
  }
}

TEST(WarpTwin, UniformHemisphereWithCosineDensityIsRejected) {
  EXPECT_LT(test_directions(square_to_uniform_hemisphere, square_to_cosine_hemisphere_pdf).p_value, 1e-12);
}

TEST(WarpTwin, PolarDiskWithoutTheSquareRootIsRejected) {
  const auto polar = [](Vec2f u) { return Vec2f{u.x * std::cos(kTwoPi * u.y), u.x * std::sin(kTwoPi * u.y)}; };
  EXPECT_LT(plane_p_value(polar, square_to_uniform_disk_pdf, -1), 1e-12);
}

TEST(WarpTwin, ProductTriangleIsRejected) {
  const auto product = [](Vec2f u) { return Vec2f{u.x, u.y * (1 - u.x)}; };
  EXPECT_LT(plane_p_value(product, square_to_uniform_triangle_pdf, 0), 1e-12);
}

}  // namespace
}  // namespace fluxfarm::testing
