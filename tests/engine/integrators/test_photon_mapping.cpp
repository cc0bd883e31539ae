// Photon mapping in two passes as a whole: catalogue G2, edges of surfaces (4.4), caustics, and what it owns up to.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "film/error_goal.h"
#include "integrators/photon/density_estimate.h"
#include "integrators/photon/density_kernel.h"
#include "integrators/photon_scenes.h"
#include "support/error.h"
#include "support/failure_row.h"
#include "worker/frame_renderer.h"

namespace fluxfarm {
namespace {

using testing::kMaxZ;
using testing::kNever;
using testing::kTwinZ;
using testing::Measurement;
using testing::percent;
using testing::replicated;
using testing::room_with_balls;
using testing::SceneBuilder;
using testing::tell_failure;

FrameResult render(const Scene& scene, const Goal& goal, std::uint64_t seed, int threads = 2, int tile = 64) {
  const PixelRect frame{0, 0, scene.film().width, scene.film().height};
  const auto integrator = make_integrator("photon", scene);
  return render_frame(scene, *integrator, {frame, tile, threads, seed, goal}, kNever);
}

Measurement mean_radiance(const SceneDescription& description, std::uint32_t spp) {
  const Scene scene(description, 1);
  return replicated([&](std::uint64_t seed) { return render(scene, {spp, {}, {}}, seed).summary.mean[1]; });
}

// A room inside a sphere of that albedo, lit by a point light off its middle, seen from inside.
SceneBuilder sphere(float albedo) {
  SceneBuilder builder;
  builder.shape(SphereDescription{{0, 0, 0}, 1}, builder.diffuse(albedo), 0, true);
  builder.emitter(PointEmitterDescription{{0.3f, 0.2f, 0}, Rgb{1}});
  builder.look({0, 0, 0}, {0, -1, 0});
  return builder;
}

SceneDescription with(const SceneBuilder& builder, bool final_gather, std::uint64_t photons = 4096) {
  SceneDescription description = builder.description();
  description.method.final_gather = final_gather;
  description.method.photons = photons;
  return description;
}

TEST(PhotonMapping, G2_IntegratingSphere) {
  constexpr double kAlbedo = 0.5;
  const double distance_squared = 0.09 + 1.44, cosine = 1.2 / std::sqrt(distance_squared);
  const double direct = cosine / distance_squared, indirect = 4 * M_PI * kAlbedo / (4 * M_PI * (1 - kAlbedo));
  const double expected = kAlbedo / M_PI * (direct + indirect);
  for (const bool final_gather : {true, false}) {
    const Measurement m = mean_radiance(with(sphere(kAlbedo), final_gather), 32);
    EXPECT_LT(m.standard_error, 0.01 * expected) << final_gather;
    EXPECT_NEAR(m.mean, expected, 0.01 * expected + kMaxZ * m.standard_error) << final_gather;
    EXPECT_GT(m.z(kAlbedo / M_PI * (2 * direct + indirect)), kTwinZ) << "direct photons counted, too";
    EXPECT_GT(m.z(kAlbedo / M_PI * (direct + indirect * kAlbedo)), kTwinZ) << "one bounce missing";
  }
}

TEST(PhotonMapping, FindsAllLightOnce) {
  SceneDescription description = with(room_with_balls(0.6f), true, 1 << 14);
  description.camera.fov_degrees = 80;
  description.film.width = description.film.height = 32;
  const Scene scene(description, 2);
  const PixelRect frame{0, 0, 32, 32};
  const auto path = make_integrator("path", scene);
  const double expected = render_frame(scene, *path, {frame, 64, 2, 1, {2048, {}, {}}}, kNever).summary.mean[1];
  const FrameResult result = render(scene, {64, {}, {}}, 1);
  EXPECT_NEAR(result.summary.mean[1], expected, 0.005 * expected);
  EXPECT_GT(*result.summary.error_bias, 0);
  // The layers add up, and caustics are in theirs.
  const Image image = result.film.image(frame, {});
  double caustic = 0;
  for (const float value : *image.find("caustic.G")) caustic += static_cast<double>(value);
  EXPECT_GT(caustic / (32 * 32), 0.005 * expected);
}

TEST(PhotonMapping, BitsDependOnNeitherThreadsNorTiles) {
  SceneDescription description = with(room_with_balls(0.6f), true);
  description.film.width = description.film.height = 40;
  description.camera.fov_degrees = 80;
  const Scene scene(description, 1);
  const Film one = render(scene, {5, {}, {}}, 3, 1, 64).film, other = render(scene, {5, {}, {}}, 3, 3, 16).film;
  for (int y = 0; y < one.height(); ++y) {
    for (int x = 0; x < one.width(); ++x) ASSERT_EQ(one.estimate(x, y).mean, other.estimate(x, y).mean) << x << " " << y;
  }
}

// A lamp shines up at a mirror, so that its image stands 2.5 above a plate that begins at x = 0 and z = 0; seen at its edge, at its
// corner and beside a box: catalogue C1 and 4.4.
TEST(PhotonMapping, Fails44_EdgesCornersAndBoxesAreRight) {
  constexpr double kAlbedo = 0.2, kReflectance = 0.8;
  const auto seen = [](float x, float z, bool box) {
    SceneBuilder builder;
    const int plate = builder.diffuse(static_cast<float>(kAlbedo));
    builder.shape(RectangleDescription{Transform::translate(1, 0, 1) * Transform::rotate(1, 0, 0, -90)}, plate);
    builder.shape(
        RectangleDescription{Transform::translate(0, 1.5, 0) * Transform::rotate(1, 0, 0, 90) * Transform::scale(0.5, 0.5, 1)},
        builder.add(ConductorDescription{.perfect = true, .specular_reflectance = Rgb{static_cast<float>(kReflectance)}}));
    builder.emitter(SpotEmitterDescription{{0, 0.5f, 0}, {0, 1, 0}, Rgb{1}, 35, 35});
    // Low, so that it stands in no light that reaches the place.
    if (box) builder.shape(testing::cube(Transform::translate(0.7, 0.02, 0.3) * Transform::scale(0.2, 0.02, 0.2)), plate);
    const auto at_x = static_cast<double>(x), at_z = static_cast<double>(z);
    builder.look({at_x + 0.2, 0.6, at_z + 0.4}, {at_x, 0, at_z}).max_depth(3);
    return mean_radiance(with(builder, false, 1 << 13), 16);
  };
  for (const auto& [key, x, z, box, unguarded] : {std::tuple{"edge of a plate", 0.002f, 0.4f, false, 0.5},
                                                  {"corner of a plate", 0.002f, 0.002f, false, 0.25},
                                                  {"crease", 0.498f, 0.3f, true, 0.5}}) {
    const double distance_squared = 6.25 + static_cast<double>(x * x + z * z);
    const double expected = kAlbedo / M_PI * kReflectance * 2.5 / std::pow(distance_squared, 1.5);
    const Measurement m = seen(x, z, box);
    EXPECT_NEAR(m.mean, expected, 0.03 * expected + kMaxZ * m.standard_error) << x << " " << z;
    EXPECT_LT(m.standard_error, 0.05 * expected);
    EXPECT_GT(m.z(unguarded * expected), kTwinZ) << "unguarded";
    tell_failure(key, "on", percent(m.mean / expected - 1));
  }
}

// A wall without thickness divides a room; the lamp is on one side.
TEST(PhotonMapping, Fails44_NoLightLeaksUnderAThinWall) {
  SceneBuilder room;
  const int wall = room.diffuse(0.5f);
  room.shape(testing::cube(Transform()), wall, 0, true);
  room.shape(RectangleDescription{Transform::rotate(0, 1, 0, 90)}, wall);
  room.emitter(PointEmitterDescription{{0.5f, 0, 0}, Rgb{1}});
  const auto seen = [&](double x, bool final_gather) {
    SceneBuilder builder = room;
    builder.look({x < 0 ? -0.5 : 0.5, 0, 0.1}, {x, -1, 0});
    return mean_radiance(with(builder, final_gather, 1 << 12), 16).mean;
  };
  for (const bool final_gather : {true, false}) {
    const double lit = seen(0.02, final_gather);
    const double dark = std::fabs(seen(-0.02, final_gather));
    EXPECT_LT(dark, 1e-3 * lit) << final_gather;
    tell_failure("thin wall over a floor", "on", percent(dark / lit) + " of the lit side");
    // Twin: the same photons without the guard.
    const Scene scene(room.description(), 1);
    const PhotonMap map(testing::shoot(scene, {.photons = 1 << 13, .seed = 1, .kinds = PhotonKind::kIndirect}).photons, 2);
    const float radius = 0.1f * scene.radius();
    const SurfacePatch patch({-0.02f, -1, 0}, {0, 1, 0}, PhotonSide::kFront, radius);
    NearestPhotons nearest;
    const Rgb leaked = estimate_by_nearest(map, patch, 64, radius, EpanechnikovKernel{}, nearest).value * (0.5f / kPi);
    EXPECT_GT(static_cast<double>(leaked.g), 0.05 * lit);
  }
}

// A floor of teeth of 45 degrees, much smaller than the disks of photons, under a lamp.
TEST(PhotonMapping, Fails44_SawTeethAreAsBrightAsPathsSeeThem) {
  SceneBuilder builder;
  MeshDescription teeth;
  constexpr int kTeeth = 200;
  for (int i = 0; i <= 2 * kTeeth; ++i) {
    const float x = -1 + static_cast<float>(i) / kTeeth, y = -1 + (i % 2 == 1 ? 1.0f / kTeeth : 0.0f);
    for (const float z : {-1.0f, 1.0f}) teeth.positions.push_back({x, y, z});
  }
  for (std::uint32_t i = 0; i < 2 * kTeeth; ++i) {
    for (const std::uint32_t corner : {0u, 1u, 2u, 2u, 1u, 3u}) teeth.indices.push_back(2 * i + corner);
  }
  builder.shape(testing::cube(Transform()), builder.diffuse(0.6f), 0, true);
  builder.shape(teeth, builder.diffuse(0.6f));
  builder.lamp_down(0, 0.99f, 0, 0.5f, 0.5f, builder.diffuse(0), 5);
  builder.look({0, 0.2, 0.3}, {0, -1, 0}).max_depth(4);
  const SceneDescription description = with(builder, true, 1 << 13);
  const Scene scene(description, 1);
  const auto path = make_integrator("path", scene);
  const Measurement expected = replicated([&](std::uint64_t seed) {
    const PixelRect frame{0, 0, scene.film().width, scene.film().height};
    return render_frame(scene, *path, {frame, 64, 2, seed, {4096, {}, {}}}, kNever).summary.mean[1];
  });
  const Measurement found = mean_radiance(description, 64);
  tell_failure("saw teeth", "on", percent(found.mean / expected.mean - 1));
  EXPECT_NEAR(found.mean, expected.mean, 0.02 * expected.mean + kMaxZ * std::hypot(found.standard_error, expected.standard_error));
  EXPECT_LT(std::hypot(found.standard_error, expected.standard_error), 0.01 * expected.mean);
}

// A goal below the blur ends without a claim, and says what to do; one above it is met.
TEST(PhotonMapping, BlurThatNoSampleTakesAwayIsNotClaimed) {
  SceneDescription description = with(room_with_balls(0.6f), false, 256);
  description.camera.fov_degrees = 80;
  description.film.width = description.film.height = 32;
  const Scene scene(description, 1);
  const FrameResult fine = render(scene, {{}, {}, 0.03}, 1);
  ASSERT_EQ(fine.warnings.size(), 1u);
  EXPECT_NE(fine.warnings[0].find("blurs the picture"), std::string::npos) << fine.warnings[0];
  EXPECT_NE(fine.warnings[0].find("photon-progressive"), std::string::npos);
  EXPECT_GT(*fine.timeline.back().error_bound, 0.03);
  tell_failure("edge of a shadow", "off", "error.bias " + percent(*fine.summary.error_bias));
  tell_failure("edge of a shadow", "on", "3 % is not claimed: \"" + fine.warnings[0] + "\"");
  EXPECT_TRUE(render(scene, {{}, {}, 0.5}, 1).warnings.empty());
}

TEST(PhotonMapping, ScenesThatMakeNoSenseSaySo) {
  SceneBuilder dark;
  dark.floor(0, 1, dark.diffuse(0.5f)).look({0, 1, 1}, {0, 0, 0});
  EXPECT_THROW(make_integrator("photon", Scene(dark.description(), 1)), SettingError);
}

}  // namespace
}  // namespace fluxfarm
