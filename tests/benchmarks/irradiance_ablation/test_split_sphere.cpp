// What split-sphere caches take from a hemisphere, against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "sampling/warp.h"
#include "split_sphere.h"

namespace fluxfarm::ablation {
namespace {

constexpr int kStrata = 64;

// By the middles of strata.
std::vector<GatheredLight> look(const std::function<GatheredLight(Vec3f)>& seen) {
  const HemisphereGrid grid(kStrata, 1e4f);
  std::vector<GatheredLight> lights;
  for (std::size_t i = 0; i < grid.size(); ++i) lights.push_back(seen(square_to_cosine_hemisphere(grid.place(i, {0.5f, 0.5f}))));
  return lights;
}

TEST(HarmonicMeanDistance, InASphereIsItsRadius) {
  EXPECT_NEAR(harmonic_mean_distance(look([](Vec3f d) { return GatheredLight{d, 3, Rgb{1}}; })), 3, 1e-5);
}

// A ceiling at height h is seen at h / cos, and the mean cosine is 2 / 3.
TEST(HarmonicMeanDistance, BelowACeilingIsThreeHalvesOfItsHeight) {
  EXPECT_NEAR(harmonic_mean_distance(look([](Vec3f d) { return GatheredLight{d, 2 / d.z, Rgb{1}}; })), 3, 0.01);
}

TEST(HarmonicMeanDistance, WithoutSurfacesIsInfinite) {
  const auto sky = look([](Vec3f d) { return GatheredLight{d, std::numeric_limits<float>::infinity(), Rgb{1}}; });
  EXPECT_TRUE(std::isinf(harmonic_mean_distance(sky)));
}

// A ceiling at height h that shines beyond x = s: E = pi / 2 (1 - s / sqrt(s^2 + h^2)).
TEST(CellGradient, BelowTheEdgeOfLightIsThatOfItsClosedForm) {
  constexpr float kHeight = 2;
  for (const float s : {-1.3f, 0.1f, 1.6f}) {
    const auto lights = look([s](Vec3f d) { return GatheredLight{d, kHeight / d.z, Rgb{d.x * kHeight / d.z > s ? 1.0f : 0.0f}}; });
    const float expected = kPi / 2 * kHeight * kHeight / std::pow(s * s + kHeight * kHeight, 1.5f);
    const PlaneGradient gradient = cell_gradient(lights);
    EXPECT_NEAR(gradient.x, expected, 0.03f * expected);
    EXPECT_NEAR(gradient.y, 0, 0.01f * expected);
  }
}

// A dark screen at a quarter of the height hides it: its edge moves four times as fast.
TEST(CellGradient, AtTheEdgeOfAScreenIsThatOfTheScreen) {
  const auto lights = look([](Vec3f d) {
    const bool hidden = d.x / d.z * 0.5f < 0.1f;
    return GatheredLight{d, (hidden ? 0.5f : 2.0f) / d.z, Rgb{hidden ? 0.0f : 1.0f}};
  });
  const float expected = kPi / 2 * 0.25f / std::pow(0.01f + 0.25f, 1.5f);
  EXPECT_NEAR(cell_gradient(lights).x, expected, 0.03f * expected);
}

TEST(CellGradient, OfEvenLightIsNothing) {
  const PlaneGradient gradient = cell_gradient(look([](Vec3f d) { return GatheredLight{d, 1 / d.z, Rgb{1}}; }));
  EXPECT_EQ(gradient.x, 0);
  EXPECT_EQ(gradient.y, 0);
}

}  // namespace
}  // namespace fluxfarm::ablation
