// Cases with known answers: direct light D1 D2 D4 D6 D7, interreflection G1 G2 G4, by the ids of the accuracy catalogue.
//
// Each is a two-sided z-test of the mean against the closed form at an overall level of 1 % over all comparisons (Sidak), with a
// standard error of at most 0.3 % of the answer, so that an error of 1 % cannot pass. Each has a must-fail twin: the same
// measurement against what a wrong renderer would give (cosine dropped, wrong constant) or a scene that is wrong by 1 or 2 %.
#include <gtest/gtest.h>

#include "support/scene_builder.h"

namespace fluxfarm::testing {
namespace {

constexpr double kPiD = 3.14159265358979323846;
// Two-sided normal quantile at 1 - (1 - 0.01)^(1/20) = 5.02e-4: there are fewer than 20 comparisons below.
constexpr double kZ = 3.48;

void expect_answer(const Measurement& m, double expected) {
  EXPECT_LE(m.standard_error, 0.003 * expected) << "too noisy to see an error of 1 %";
  EXPECT_LE(m.z(expected), kZ) << "measured " << m.mean << " +- " << m.standard_error << ", expected " << expected;
}

void expect_rejected(const Measurement& m, double wrong) {
  EXPECT_GT(m.z(wrong), kZ) << "the test has no teeth: measured " << m.mean << " +- " << m.standard_error << " passes for "
                            << wrong;
}

constexpr float kRho = 0.8f;

// D1: E = I h / (h^2 + x^2)^1.5.
SceneBuilder point_over_plane(double x) {
  SceneBuilder scene;
  scene.floor(0, 20, scene.diffuse(kRho));
  scene.emitter(PointEmitterDescription{{0, 1, 0}, Rgb{1.0f}});
  scene.look({x + 0.5, 2, 0.5}, {x, 0, 0});
  return scene;
}

TEST(CatalogueD1, PointLightOverPlane) {
  for (const auto& [x, e] : {std::pair{0.0, 1.0}, std::pair{1.0, 0.353553391}}) {
    const Measurement m = measure(point_over_plane(x).description(), 8);
    EXPECT_NEAR(m.mean, static_cast<double>(kRho) / kPiD * e, 1e-4 * e);  // one sample is the answer: nothing is random
    const double without_cosine = static_cast<double>(kRho) / kPiD / (1 + x * x);
    EXPECT_EQ(std::abs(m.mean - without_cosine) > 1e-2, x > 0) << "the cosine matters off axis only";
  }
}

// D1 under a spot light: the intensity falls off linearly in the angle; x = tan(angle).
TEST(CatalogueD1, SpotLightOverPlane) {
  for (const auto& [degrees, share] : {std::pair{0.0, 1.0}, std::pair{25.0, 0.5}, std::pair{35.0, 0.0}}) {
    const double x = std::tan(degrees * kPiD / 180);
    SceneBuilder scene;
    scene.floor(0, 20, scene.diffuse(kRho));
    scene.emitter(SpotEmitterDescription{{0, 1, 0}, {0, -1, 0}, Rgb{2.0f}, 30, 20});
    scene.look({x + 0.5, 2, 0.5}, {x, 0, 0});
    const double without_falloff = static_cast<double>(kRho) / kPiD * 2 / std::pow(1 + x * x, 1.5);
    const double mean = measure(scene.description(), 8).mean;
    EXPECT_NEAR(mean, share * without_falloff, 3e-4);  // nothing is random; the camera's pixels are small, not points
    EXPECT_EQ(std::abs(mean - without_falloff) > 1e-2, share < 1) << "the fall-off matters off axis only";
  }
}

// D1 under parallel light: E = E_perpendicular cos, with and without something far away in between.
TEST(CatalogueD1, DirectionalLightOnPlane) {
  for (const bool shadow : {false, true}) {
    SceneBuilder scene;
    scene.floor(0, 20, scene.diffuse(kRho));
    scene.emitter(DirectionalEmitterDescription{{0.6f, -0.8f, 0}, Rgb{2.0f}});
    if (shadow) scene.shape(SphereDescription{{-600, 800, 0}, 1}, scene.diffuse(0));
    scene.look({0.5, 2, 0.5}, {0, 0, 0});
    const double mean = measure(scene.description(), 8).mean;
    EXPECT_NEAR(mean, shadow ? 0 : static_cast<double>(kRho) / kPiD * 2 * 0.8, 1e-5);
    EXPECT_GT(std::abs(mean - static_cast<double>(kRho) / kPiD * 2), 0.1) << "a renderer without the cosine is told apart";
  }
}

// The choice of emitters is paid for: several lights of all kinds add up.
TEST(CatalogueD1, DeltaLightsAddUp) {
  SceneBuilder scene;
  scene.floor(0, 20, scene.diffuse(kRho));
  scene.emitter(PointEmitterDescription{{0, 1, 0}, Rgb{1.0f}});
  scene.emitter(SpotEmitterDescription{{0, 1, 0}, {0, -1, 0}, Rgb{2.0f}, 30, 20});
  scene.emitter(DirectionalEmitterDescription{{0, -1, 0}, Rgb{3.0f}});
  scene.look({0.5, 2, 0.5}, {0, 0, 0});
  const Measurement m = measure(scene.description(), 4096);
  expect_answer(m, static_cast<double>(kRho) / kPiD * 6);
  expect_rejected(m, static_cast<double>(kRho) / kPiD * 6 * 1.02);
}

// D2: form factor of a parallel rectangle, centred 1 x 1 at distance 1, and a corner above the point.
TEST(CatalogueD2, ParallelRectangle) {
  for (const auto& [a, b, d, offset, f] :
       {std::tuple{1.0f, 1.0f, 1.0f, 0.0f, 0.2394565}, std::tuple{1.0f, 0.5f, 0.7f, 0.5f, 0.1302817}}) {
    SceneBuilder scene;
    scene.floor(0, 20, scene.diffuse(kRho));
    scene.lamp_down(offset * a, d, offset * b, a, b, scene.diffuse(0), 2);
    scene.look({-1.5, 1, 0}, {0, 0, 0}).max_depth(2);
    const Measurement m = measure(scene.description(), 1024);
    const double expected = static_cast<double>(kRho) * 2 * f;
    expect_answer(m, expected);
    expect_rejected(m, expected * 1.02);
  }
}

TEST(CatalogueD2, TwinWithoutCosineIsRejected) {
  // A renderer that drops the receiver's cosine sees the solid angle over pi in place of the form factor.
  SceneBuilder scene;
  scene.floor(0, 20, scene.diffuse(kRho));
  scene.lamp_down(0, 1, 0, 1, 1, scene.diffuse(0), 2);
  scene.look({-1.5, 1, 0}, {0, 0, 0}).max_depth(2);
  const double solid_angle = 4 * std::asin(0.25 / 1.25);  // of a square of side 1 from distance 1 on its axis
  expect_rejected(measure(scene.description(), 1024), static_cast<double>(kRho) * 2 * solid_angle / kPiD);
}

// D4: disk of radius R at height h on axis, F = R^2 / (R^2 + h^2).
TEST(CatalogueD4, DiskOnAxis) {
  SceneBuilder scene;
  scene.floor(0, 20, scene.diffuse(kRho));
  scene.shape(DiskDescription{Transform::translate(0, 1, 0) * Transform::rotate(1, 0, 0, 90)}, scene.diffuse(0), 2);
  scene.look({-1.5, 0.8, 0}, {0, 0, 0}).max_depth(2);
  const Measurement m = measure(scene.description(), 2048);
  expect_answer(m, static_cast<double>(kRho) * 2 * 0.5);
  expect_rejected(m, static_cast<double>(kRho) * 2 * 0.51);
}

// D6: sphere of radius R at distance d wholly above the horizon, F = (R/d)^2 cos(theta).
TEST(CatalogueD6, SphereAboveHorizon) {
  for (const double degrees : {0.0, 40.0}) {
    const double radians = degrees * kPiD / 180;
    SceneBuilder scene;
    scene.floor(0, 20, scene.diffuse(kRho));
    scene.shape(SphereDescription{{static_cast<float>(2 * std::sin(radians)), static_cast<float>(2 * std::cos(radians)), 0}, 1},
                scene.diffuse(0), 2);
    scene.look({-1.5, 0.5, 0}, {0, 0, 0}).max_depth(2);
    const Measurement m = measure(scene.description(), 256);
    const double expected = static_cast<double>(kRho) * 2 * 0.25 * std::cos(radians);
    expect_answer(m, expected);
    expect_rejected(m, expected * 1.02);
    if (degrees > 0) expect_rejected(m, static_cast<double>(kRho) * 2 * 0.25);  // cosine dropped
  }
}

// D7: uniform sky, unoccluded, E = pi Le.
TEST(CatalogueD7, UniformSky) {
  SceneBuilder scene;
  scene.floor(0, 20, scene.diffuse(kRho));
  scene.emitter(ConstantEmitterDescription{Rgb{3.0f}});
  scene.look({0, 1, 0}, {0, 0, 0});
  const Measurement m = measure(scene.description(), 64);
  expect_answer(m, static_cast<double>(kRho) * 3);
  expect_rejected(m, static_cast<double>(kRho) * 3 * 1.01);
}

// D7 under glossy reflection: an ideal conductor hides nothing of the sky.
TEST(CatalogueD7, PerfectMirrorShowsTheSky) {
  SceneBuilder scene;
  scene.floor(0, 20, scene.add(ConductorDescription{.perfect = true}));
  scene.emitter(ConstantEmitterDescription{Rgb{3.0f}});
  scene.look({0, 1, 0.3}, {0, 0, 0});
  expect_answer(measure(scene.description(), 8), 3);
}

// G1: closed furnace, every surface emits Le with albedo rho: L = Le / (1 - rho), with n bounces Le (1 - rho^(n+1)) / (1 - rho).
SceneBuilder furnace(float rho) {
  SceneBuilder scene;
  const int wall = scene.diffuse(rho);
  scene.shape(SphereDescription{{0, 0, 0}, 3}, wall, 1, true);
  scene.shape(SphereDescription{{0.5f, -1, 0.4f}, 0.7f}, wall, 1);
  scene.shape(cube(Transform::translate(-1, 0.4, 0.5) * Transform::rotate(0.3, 1, 0.2, 70) * Transform::scale(0.5, 0.9, 0.6)), wall,
              1);
  scene.look({1, 1, -1}, {0.5, -0.31, 0.4});
  return scene;
}

TEST(CatalogueG1, ClosedFurnace) {
  const Measurement half = measure(furnace(0.5f).description(), 256);
  expect_answer(half, 2);
  expect_rejected(half, 2 * 1.02);
  const Measurement bright = measure(furnace(0.9f).description(), 4096);
  expect_answer(bright, 10);
  expect_rejected(bright, 10 * 1.02);
}

TEST(CatalogueG1, FurnaceWithFourBounces) {
  const Measurement m = measure(furnace(0.9f).max_depth(5).description(), 256);
  expect_answer(m, 4.0951);
  expect_rejected(m, 3.439);    // one bounce less
  expect_rejected(m, 4.68559);  // one bounce more
}

// G2: integrating sphere, point light anywhere inside: E_indirect = Phi rho / (4 pi R^2 (1 - rho)), uniform on the wall.
TEST(CatalogueG2, IntegratingSphereWithLightOffCentre) {
  const double radius = 2, rho = 0.6, intensity = 5;
  SceneBuilder scene;
  scene.shape(SphereDescription{{0, 0, 0}, static_cast<float>(radius)}, scene.diffuse(static_cast<float>(rho)), 0, true);
  scene.emitter(PointEmitterDescription{{0.9f, 0.4f, -0.3f}, Rgb{static_cast<float>(intensity)}});
  scene.look({-0.5, 0, 0}, {-2, 0, 0});
  // Direct light at the point (-2, 0, 0) of the wall, whose normal is +x.
  const double d2 = 2.9 * 2.9 + 0.4 * 0.4 + 0.3 * 0.3;
  const double direct = intensity * (2.9 / std::sqrt(d2)) / d2;
  const double indirect = 4 * kPiD * intensity * rho / (4 * kPiD * radius * radius * (1 - rho));
  const Measurement m = measure(scene.description(), 4096);
  expect_answer(m, rho / kPiD * (direct + indirect));
  expect_rejected(m, rho / kPiD * (direct + 1.02 * indirect));
  expect_rejected(m, rho / kPiD * direct);
}

// G4: concentric spheres, the inner one emits: E_outer = s pi Le / (1 - rho (1 - s) - s rho ri), s = (a/R)^2.
TEST(CatalogueG4, ConcentricSpheres) {
  for (const auto& [inner, rho, ri, share] :
       {std::tuple{1.0, 0.8f, 0.0f, 0.625}, std::tuple{1.0, 0.8f, 0.5f, 0.8333333}, std::tuple{0.4, 0.5f, 0.0f, 0.0769231}}) {
    SceneBuilder scene;
    scene.shape(SphereDescription{{0, 0, 0}, static_cast<float>(inner)}, scene.diffuse(ri), 2);
    scene.shape(SphereDescription{{0, 0, 0}, 2}, scene.diffuse(rho), 0, true);
    scene.look({-1.5, 0.3, 0.2}, {-1.9, -0.6, 0.2});
    const Measurement m = measure(scene.description(), 2048);
    const double expected = static_cast<double>(rho) * share * 2;
    expect_answer(m, expected);
    expect_rejected(m, expected * 1.02);
  }
}

TEST(CatalogueG4, TwinWithAlbedoWrongByOnePercentIsRejected) {
  SceneBuilder scene;
  scene.shape(SphereDescription{{0, 0, 0}, 1}, scene.diffuse(0.0f), 2);
  scene.shape(SphereDescription{{0, 0, 0}, 2}, scene.diffuse(0.8f * 1.01f), 0, true);
  scene.look({-1.5, 0.3, 0.2}, {-1.9, -0.6, 0.2});
  expect_rejected(measure(scene.description(), 2048), 0.8 * 0.625 * 2);
}

}  // namespace
}  // namespace fluxfarm::testing
