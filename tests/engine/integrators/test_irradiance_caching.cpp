// Irradiance caching as a whole: catalogue G1, G2, G4, G6, many bounces, and what it shares with all methods.
#include <gtest/gtest.h>

#include <cmath>

#include "integrators/photon_scenes.h"
#include "support/error.h"
#include "worker/frame_renderer.h"

namespace fluxfarm {
namespace {

using testing::cube;
using testing::kMaxZ;
using testing::kNever;
using testing::kTwinZ;
using testing::Measurement;
using testing::render;
using testing::replicated;
using testing::room_with_balls;
using testing::SceneBuilder;

constexpr const char* kMethod = "irradiance-cache";

// With a wide view of so many pixels.
SceneDescription wide(const SceneBuilder& builder, int side = 24) {
  SceneDescription description = builder.description();
  description.camera.fov_degrees = 70;
  description.film.width = description.film.height = side;
  return description;
}

// Of the green channel over the frame; each seed has caches of its own.
Measurement frame_mean(const SceneDescription& description, std::uint32_t spp) {
  const Scene scene(description, 1);
  return replicated([&](std::uint64_t seed) { return render(scene, kMethod, spp, seed).summary().mean[1]; });
}

void expect_answer(const Measurement& m, double expected) {
  EXPECT_LT(m.standard_error, 0.003 * expected);
  EXPECT_NEAR(m.mean, expected, 0.005 * expected + kMaxZ * m.standard_error) << m.mean << " +- " << m.standard_error;
  EXPECT_GT(std::fabs(m.mean - 1.02 * expected) / m.standard_error, kTwinZ) << "no teeth";
}

TEST(IrradianceCaching, G1_ClosedFurnace) {
  for (const float albedo : {0.5f, 0.9f}) {
    SceneBuilder builder;
    builder.shape(cube(Transform::scale(1, 1, 1)), builder.diffuse(albedo), 1, true).look({0.2, 0.1, 0.5}, {0, 0, -1});
    expect_answer(frame_mean(wide(builder), 16), 1 / (1 - static_cast<double>(albedo)));
  }
}

TEST(IrradianceCaching, G2_IntegratingSphere) {
  constexpr double kAlbedo = 0.6, kRadius = 2, kIntensity = 5;
  SceneBuilder builder;
  builder.shape(SphereDescription{{0, 0, 0}, static_cast<float>(kRadius)}, builder.diffuse(static_cast<float>(kAlbedo)), 0, true);
  builder.emitter(PointEmitterDescription{{0.9f, 0.4f, -0.3f}, Rgb{static_cast<float>(kIntensity)}}).look({-0.5, 0, 0}, {-2, 0, 0});
  // Direct light at (-2, 0, 0), whose normal is +x.
  const double d2 = 2.9 * 2.9 + 0.4 * 0.4 + 0.3 * 0.3, direct = kIntensity * (2.9 / std::sqrt(d2)) / d2;
  const double indirect = 4 * M_PI * kIntensity * kAlbedo / (4 * M_PI * kRadius * kRadius * (1 - kAlbedo));
  const Measurement m = frame_mean(builder.description(), 64);
  expect_answer(m, kAlbedo / M_PI * (direct + indirect));
  EXPECT_GT(m.z(kAlbedo / M_PI * (direct + kAlbedo * indirect)), kTwinZ) << "one bounce missing";
}

TEST(IrradianceCaching, G4_ConcentricSpheres) {
  for (const auto& [inner, rho, ri, share] : {std::tuple{1.0f, 0.8f, 0.5f, 0.8333333}, std::tuple{0.4f, 0.5f, 0.0f, 0.0769231}}) {
    SceneBuilder builder;
    builder.shape(SphereDescription{{0, 0, 0}, inner}, builder.diffuse(ri), 2);
    builder.shape(SphereDescription{{0, 0, 0}, 2}, builder.diffuse(rho), 0, true);
    builder.look({-1.5, 0.3, 0.2}, {-1.9, -0.6, 0.2});
    expect_answer(frame_mean(builder.description(), 256), static_cast<double>(rho) * share * 2);
  }
}

// G6: the mean indirect irradiance of a cube's walls with a point light in its middle; seen from the middle all walls look alike,
// and the mean over one wall is that over all.
TEST(IrradianceCaching, G6_CubeWithALampInItsMiddle) {
  constexpr double kAlbedo = 0.5, kSide = 4, kIntensity = 3;
  SceneBuilder builder;
  builder.shape(cube(Transform::scale(2, 2, 2)), builder.diffuse(static_cast<float>(kAlbedo)), 0, true);
  builder.emitter(PointEmitterDescription{{0, 0, 0}, Rgb{static_cast<float>(kIntensity)}}).look({0, 0, 0}, {0, 0, -1});
  SceneDescription description = builder.description();
  description.camera.fov_degrees = 90;  // one wall, and no more
  description.film.width = description.film.height = 32;
  // The film is evenly spread over the wall, so its mean is the wall's.
  const double flux = 4 * M_PI * kIntensity, area = 6 * kSide * kSide;
  const double indirect = flux * kAlbedo / (area * (1 - kAlbedo)), direct = flux / area;
  expect_answer(frame_mean(description, 16), kAlbedo / M_PI * (direct + indirect));
}

TEST(IrradianceCaching, FindsAllLightOnce) {
  for (const int max_depth : {-1, 4}) {
    SceneDescription description = wide(room_with_balls(0.6f).max_depth(max_depth), 32);
    const Scene scene(description, 2);
    const double expected = render(scene, "path", 2048, 1).summary().mean[1];
    const Film film = render(scene, kMethod, 128, 1);
    EXPECT_NEAR(film.summary().mean[1], expected, 0.007 * expected) << max_depth;
    EXPECT_GT(film.summary().error_bias.value_or(0), 0);
    // Twin: without the caustics that photons bring.
    const Image image = film.image({0, 0, 32, 32}, {});
    double caustic = 0;
    for (const float value : *image.find("caustic.G")) caustic += static_cast<double>(value) / (32 * 32);
    EXPECT_LT(film.summary().mean[1] - caustic, (1 - 0.007) * expected) << max_depth;
  }
}

TEST(IrradianceCaching, ManyBouncesInABrightRoom) {
  SceneBuilder builder;
  builder.shape(cube(Transform::scale(2, 1, 1)), builder.diffuse(0.9f), 0, true);
  builder.shape(cube(Transform::translate(0.5, -0.7, 0) * Transform::scale(0.3, 0.3, 0.3)), builder.diffuse(0.9f));
  builder.lamp_down(-1, 0.99f, 0, 0.5, 0.5, builder.diffuse(0), 5).look({1.8, 0.3, 0.6}, {0, -0.4, 0});
  const Scene scene(wide(builder, 32), 2);
  const double expected = render(scene, "path", 1024, 1).summary().mean[1];
  EXPECT_NEAR(render(scene, kMethod, 64, 1).summary().mean[1], expected, 0.01 * expected);
}

// Light of an even sky is cached, too, and must not come twice.
TEST(IrradianceCaching, SeesAnEvenSkyOnce) {
  SceneBuilder builder;
  builder.floor(0, 2, builder.diffuse(0.5f));
  builder.shape(cube(Transform::translate(0.4, 0.3, 0) * Transform::scale(0.2, 0.3, 0.2)), builder.diffuse(0.5f));
  builder.emitter(ConstantEmitterDescription{Rgb{1}}).look({1, 1.5, 2}, {0.2, 0.2, 0});
  SceneDescription description = wide(builder, 32);
  description.camera.fov_degrees = 30;
  const Scene scene(description, 2);
  const double expected = render(scene, "path", 1024, 1).summary().mean[1];
  EXPECT_NEAR(render(scene, kMethod, 64, 1).summary().mean[1], expected, 0.005 * expected);
}

TEST(IrradianceCaching, BitsDependOnNeitherThreadsNorTiles) {
  const Scene scene(wide(room_with_balls(0.6f), 40), 1);
  const Film one = render(scene, kMethod, 20, 3);
  testing::expect_bits_of_neither_threads_nor_tiles(scene, kMethod, 20);
  EXPECT_NE(one.estimate(20, 20).mean, render(scene, kMethod, 20, 4).estimate(20, 20).mean);
}

TEST(IrradianceCaching, IsPathTracingWhereNothingIsDiffuse) {
  SceneBuilder builder;
  builder.floor(0, 2, builder.add(RoughConductorDescription{}));
  builder.lamp_down(0, 2, 0, 1, 1, builder.add(RoughConductorDescription{}), 3).look({2, 1, 0}, {0, 0, 0});
  const Scene scene(wide(builder, 16), 1);
  const Film cached = render(scene, kMethod, 3, 5), paths = render(scene, "path", 3, 5);
  EXPECT_FALSE(cached.biased());
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) ASSERT_EQ(cached.estimate(x, y).mean, paths.estimate(x, y).mean);
  }
}

TEST(IrradianceCaching, RefusesMedia) {
  SceneBuilder builder;
  builder.shape(SphereDescription{{0, 0, 0}, 1}, builder.add(NullDescription{}));
  builder.interior(builder.medium({Rgb{1}, Rgb{0.5f}, 0}));
  builder.emitter(ConstantEmitterDescription{Rgb{1}}).look({0, 0, 3}, {0, 0, 0});
  const Scene scene(builder.description(), 1);
  try {
    make_integrator(kMethod, scene);
    FAIL();
  } catch (const SettingError& error) {
    EXPECT_NE(std::string(error.what()).find("irradiance-cache does not model"), std::string::npos);
  }
}

}  // namespace
}  // namespace fluxfarm
