// Irradiance with its derivatives from a hemisphere of strata: edges against closed forms, and a hemisphere of a known scene
// against differences of its exact irradiance, with what hides and comes into sight.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "integrators/irradiance/hemisphere_grid.h"
#include "sampling/warp.h"

namespace fluxfarm {
namespace {

// ---------------------------------------------------------------- edges

// Of the square of half side `half` at height one, with its middle at (x, y) from the receiver; radiance one.
EdgeIrradiance square_irradiance(float x, float y, float half) {
  const Vec3f corners[4] = {{x - half, y - half, 1}, {x + half, y - half, 1}, {x + half, y + half, 1}, {x - half, y + half, 1}};
  EdgeIrradiance sum;
  for (int i = 0; i < 4; ++i) {
    const EdgeIrradiance edge = edge_irradiance(corners[i], corners[(i + 1) % 4]);
    sum.value += edge.value;
    sum.gradient_x += edge.gradient_x;
    sum.gradient_y += edge.gradient_y;
    sum.hessian.xx += edge.hessian.xx;
    sum.hessian.xy += edge.hessian.xy;
    sum.hessian.yy += edge.hessian.yy;
  }
  return sum;
}

TEST(EdgeIrradiance, OfASquareHasItsClosedForm) {
  // The form factor of a square whose corner stands over the receiver, four times [Howell, configuration C-13].
  const double half = 0.7, w = half / std::sqrt(1 + half * half);
  const double expected = 4 * w * std::atan(w);
  EXPECT_NEAR(square_irradiance(0, 0, 0.7f).value, expected, 1e-6);
  EXPECT_NEAR(square_irradiance(0, 0, 1e3f).value, M_PI, 1e-5);  // the whole sky
  EXPECT_LT(square_irradiance(0.3f, 0, 0.7f).value, expected);
}

TEST(EdgeIrradiance, DerivativesAreThoseOfItsValue) {
  constexpr float kStep = 1.0f / 64;
  constexpr double kStepD = 1.0 / 64;
  for (const auto& [x, y] : {std::pair{0.25f, -0.5f}, std::pair{1.5f, 0.75f}, std::pair{0.0f, 0.0f}}) {
    const EdgeIrradiance at = square_irradiance(x, y, 0.5f);
    // A step of the receiver moves the square the other way.
    const auto moved = [&, x = x, y = y](float dx, float dy) { return square_irradiance(x - dx, y - dy, 0.5f); };
    const EdgeIrradiance right = moved(kStep, 0), left = moved(-kStep, 0), up = moved(0, kStep), down = moved(0, -kStep);
    EXPECT_NEAR(at.gradient_x, (right.value - left.value) / (2 * kStepD), 2e-4);
    EXPECT_NEAR(at.gradient_y, (up.value - down.value) / (2 * kStepD), 2e-4);
    EXPECT_NEAR(at.hessian.xx, (right.gradient_x - left.gradient_x) / (2 * kStepD), 1e-3);
    EXPECT_NEAR(at.hessian.xy, (up.gradient_x - down.gradient_x) / (2 * kStepD), 1e-3);
    EXPECT_NEAR(at.hessian.yy, (up.gradient_y - down.gradient_y) / (2 * kStepD), 1e-3);
  }
  EXPECT_LT(square_irradiance(0, 0, 0.5f).hessian.xx, -0.5);  // brightest below the middle: the checks are not of zeros
  EXPECT_LT(square_irradiance(1.5f, 0, 0.5f).gradient_x, square_irradiance(-1.5f, 0, 0.5f).gradient_x + 2);
  EXPECT_GT(square_irradiance(1.5f, 0, 0.5f).gradient_x, 0.1);
}

TEST(EdgeIrradiance, OnALineThroughTheReceiverIsNothing) {
  const EdgeIrradiance edge = edge_irradiance({0.1f, 0, 0.1f}, {0.3f, 0, 0.3f});
  EXPECT_EQ(edge.value, 0);
  EXPECT_EQ(edge.hessian.xx, 0);
}

// ---------------------------------------------------------------- hemispheres

struct Seen {
  float distance;
  float radiance;
};
using View = std::function<Seen(Vec3f origin, Vec3f direction)>;

// With `jitter` in each stratum, or at its middle.
HemisphereGrid look(const View& view, Vec3f origin, int strata, std::mt19937* jitter = nullptr) {
  HemisphereGrid grid(strata, 1e4f);
  std::uniform_real_distribution<float> unit(0, 1);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Vec2f u = jitter != nullptr ? Vec2f{unit(*jitter), unit(*jitter)} : Vec2f{0.5f, 0.5f};
    GatheredLight& light = grid.light(i);
    light.direction = square_to_cosine_hemisphere(grid.place(i, u));
    const Seen seen = view(origin, light.direction);
    light.distance = seen.distance;
    light.radiance = {seen.radiance, 2 * seen.radiance, 0};
  }
  return grid;
}

// A ceiling at height 2 that shines on one side of a line and fades smoothly on the other.
Seen smooth_ceiling(Vec3f origin, Vec3f direction) {
  const float t = (2 - origin.z) / direction.z;
  const Vec3f at = origin + t * direction;
  return {t, 1 + 0.5f * std::sin(at.x) * std::cos(0.5f * at.y)};
}

// Behind a dark plate at height 0.5.
Seen hidden_ceiling(Vec3f origin, Vec3f direction) {
  const float t = (0.5f - origin.z) / direction.z;
  const Vec3f at = origin + t * direction;
  if (at.x > 0.4f && at.x < 1.4f && std::fabs(at.y) < 0.6f) return {t, 0};
  return smooth_ceiling(origin, direction);
}

// A wall at distance 1, brighter above, up to a ceiling at height 2. Light does not jump anywhere.
Seen fading_wall(Vec3f origin, Vec3f direction) {
  const float up = (2 - origin.z) / direction.z, across = (1 - origin.x) / direction.x;
  return direction.x > 0 && across < up ? Seen{across, 0.2f + 0.4f * across * direction.z} : Seen{up, 1};
}

// By a fine grid, and differences of it.
HemisphereIrradiance exact(const View& view) {
  constexpr float kStep = 0.05f;
  const auto irradiance = [&](float x, float y) { return look(view, {x, y, 0}, 512).irradiance().irradiance; };
  const Rgb middle = irradiance(0, 0), right = irradiance(kStep, 0), left = irradiance(-kStep, 0), up = irradiance(0, kStep),
            down = irradiance(0, -kStep);
  HemisphereIrradiance result;
  result.irradiance = middle;
  result.gradient_x = (right - left) / (2 * kStep);
  result.gradient_y = (up - down) / (2 * kStep);
  const auto second = [&](Rgb a, Rgb b) { return static_cast<double>(luminance(a + b - 2 * middle) / (kStep * kStep)); };
  result.hessian.xx = second(left, right);
  result.hessian.yy = second(up, down);
  return result;
}

void expect_derivatives(const View& view, int strata, double tolerance) {
  const HemisphereIrradiance truth = exact(view), found = look(view, {}, strata).irradiance();
  const double scale = static_cast<double>(truth.irradiance.g);
  EXPECT_NEAR(static_cast<double>(found.irradiance.g), scale, 0.01 * scale);
  EXPECT_NEAR(static_cast<double>(found.gradient_x.g), static_cast<double>(truth.gradient_x.g), tolerance * scale);
  EXPECT_NEAR(static_cast<double>(found.gradient_y.g), static_cast<double>(truth.gradient_y.g), tolerance * scale);
  EXPECT_NEAR(found.gradient_x.r, 0.5f * found.gradient_x.g, 1e-4f);
  EXPECT_NEAR(found.hessian.xx, truth.hessian.xx, 2 * tolerance * scale);
  EXPECT_NEAR(found.hessian.yy, truth.hessian.yy, 2 * tolerance * scale);
}

TEST(HemisphereGrid, DerivativesUnderACeilingThatChanges) { expect_derivatives(smooth_ceiling, 64, 0.02); }

// What is at the horizon moves past it: without that the gradient here would be a half, 0.06 of the irradiance less.
TEST(HemisphereGrid, DerivativesBesideAWallThatFades) { expect_derivatives(fading_wall, 64, 0.01); }

TEST(HemisphereGrid, DerivativesSeeWhatHides) {
  // The rim of the plate is known to half a stratum, on the side that hides.
  expect_derivatives(hidden_ceiling, 64, 0.18);
  expect_derivatives(hidden_ceiling, 256, 0.06);
  // Twin: the light alone, as if nothing was in the way of it when the place moves.
  const HemisphereIrradiance truth = exact(hidden_ceiling), unhidden = look(smooth_ceiling, {}, 64).irradiance();
  EXPECT_GT(std::fabs(truth.gradient_x.g - unhidden.gradient_x.g), 0.2f * truth.irradiance.g);
}

TEST(HemisphereGrid, ATurnIsTheScalarProductWithTheNormal) {
  // From above alone, so that no light comes to the horizon.
  const View spot = [](Vec3f, Vec3f d) { return Seen{1, d.x + 0.3f * d.y + 2 * d.z > 1.8f ? 1.0f : 0.0f}; };
  const HemisphereIrradiance e = look(spot, {}, 64).irradiance();
  const Vec3f normal = normalize(Vec3f{0.2f, -0.1f, 1});
  double turned = 0;
  constexpr int kFine = 512;
  for (int i = 0; i < kFine * kFine; ++i) {
    const Vec3f d = square_to_cosine_hemisphere(
        {(static_cast<float>(i % kFine) + 0.5f) / kFine, (static_cast<float>(i / kFine) + 0.5f) / kFine});
    turned += static_cast<double>(spot({}, d).radiance * dot(normal, d) / d.z) * M_PI / (kFine * kFine);
  }
  const float found = e.irradiance.r * normal.z + e.turned_x.r * normal.x + e.turned_y.r * normal.y;
  EXPECT_NEAR(static_cast<double>(found), turned, 0.01 * turned);
  EXPECT_GT(std::fabs(static_cast<double>(e.irradiance.r) - turned), 0.03 * turned);  // it is not the unturned one
}

TEST(HemisphereGrid, ReplicatesAreHemispheresOfTheirOwn) {
  std::mt19937 random(1);
  const HemisphereGrid grid = look(smooth_ceiling, {}, 32, &random);
  std::array<int, kReplicates> count{};
  for (std::size_t i = 0; i < grid.size(); ++i) ++count[grid.replicate(i)];
  for (const int strata : count) EXPECT_EQ(strata, 32 * 32 / static_cast<int>(kReplicates));
  const HemisphereIrradiance e = grid.irradiance();
  Rgb mean;
  for (const Rgb& replicate : e.by_replicate) {
    mean += replicate / static_cast<float>(kReplicates);
    EXPECT_NEAR(replicate.g, e.irradiance.g, 0.05f * e.irradiance.g);
  }
  EXPECT_NEAR(mean.g, e.irradiance.g, 1e-4f * e.irradiance.g);
}

// Beside a wall at distance 0.5 that bars x > 0.5, under a ceiling at height 5.
Seen room_with_wall(Vec3f origin, Vec3f direction) {
  const float up = (5 - origin.z) / direction.z, across = (0.5f - origin.x) / direction.x;
  return direction.x > 0 && across < up ? Seen{across, 3} : Seen{up, 1};
}

TEST(HemisphereGrid, ClearanceIsLongBesideAWall) {
  const HemisphereIrradiance e = look(room_with_wall, {}, 32).irradiance();
  EXPECT_NEAR(length(e.nearest), 0.5f, 0.05f);
  const double across = 1 / std::sqrt(e.clearance.xx), along = 1 / std::sqrt(e.clearance.yy);
  EXPECT_LT(across, 0.5);
  EXPECT_GT(across, 0.35);
  EXPECT_GT(along, 3);
  EXPECT_NEAR(e.clearance.xy, 0, 0.1);
  const Rgb wall{3, 6, 0};
  EXPECT_NEAR(e.near_irradiance, luminance(wall) * kPi, 0.5f);
}

// Strata that differ by chance make gradients that are nothing but noise.
TEST(HemisphereGrid, GradientsOfNoiseAreTakenForNoise) {
  std::mt19937 random(7);
  std::exponential_distribution<float> noise(1);
  const View dome = [&](Vec3f, Vec3f) { return Seen{1, noise(random)}; };
  double squares = 0, claimed = 0, kept = 0;
  constexpr int kTrials = 200;
  for (int i = 0; i < kTrials; ++i) {
    const HemisphereIrradiance e = look(dome, {}, 16).irradiance();
    claimed += static_cast<double>(e.gradient_noise * e.gradient_noise) / kTrials;
    kept += static_cast<double>(luminance(e.gradient_x) * luminance(e.gradient_x)) / kTrials;
  }
  // Of strata without noise reduction: the gradient's variance, from a dome with the same noise around a slope that is known.
  const View slope = [&](Vec3f, Vec3f d) { return Seen{1, 20 * (1 + d.x) + noise(random)}; };
  double mean = 0;
  std::vector<double> gradients;
  for (int i = 0; i < kTrials; ++i) {
    gradients.push_back(static_cast<double>(luminance(look(slope, {}, 16).irradiance().gradient_x)));
    mean += gradients.back() / kTrials;
  }
  for (const double g : gradients) squares += (g - mean) * (g - mean) / kTrials;
  EXPECT_GT(claimed, 0.6 * squares);
  EXPECT_LT(claimed, 1.6 * squares);
  EXPECT_LT(kept, 0.5 * squares);
  EXPECT_GT(std::fabs(mean), 10 * std::sqrt(squares / kTrials));  // and what is a slope is kept
}

}  // namespace
}  // namespace fluxfarm
