// The pilot that chooses a method: what it takes where, and that it keeps what it made.
#include <gtest/gtest.h>

#include <algorithm>

#include "integrators/photon_scenes.h"
#include "support/scene_builder.h"
#include "worker/frame_renderer.h"
#include "worker/pilot.h"
#include "worker/pilot_trial.h"

namespace fluxfarm {
namespace {

using testing::cube;
using testing::kNever;
using testing::SceneBuilder;

constexpr PixelRect kFrame{0, 0, 96, 64};

SceneDescription in_frame(const SceneBuilder& builder) {
  SceneDescription description = builder.description();
  description.camera.fov_degrees = 60;
  description.film.width = kFrame.width;
  description.film.height = kFrame.height;
  return description;
}

SceneBuilder white_room() {
  SceneBuilder builder;
  builder.shape(cube(Transform::scale(1.5, 1, 1.5)), builder.diffuse(0.8f), 0, true);
  builder.lamp_down(0, 0.99f, 0, 0.5f, 0.5f, builder.diffuse(0), 8);
  builder.look({0, 0, 1.4}, {0, -0.3, 0});
  return builder;
}

SceneBuilder lit_plane() {
  SceneBuilder builder;
  builder.floor(0, 40, builder.diffuse(0.5f));
  builder.lamp_down(0, 3, 0, 1, 1, builder.diffuse(0), 8);
  builder.look({0, 1.5, -4}, {0, 0, 0});
  return builder;
}

// A small lamp over a glass ball in a room.
SceneBuilder glass_ball() {
  SceneBuilder builder;
  builder.shape(cube(Transform::scale(1.5, 1, 1.5)), builder.diffuse(0.6f), 0, true);
  builder.lamp_down(0, 0.99f, 0, 0.05f, 0.05f, builder.diffuse(0), 400);
  builder.shape(SphereDescription{{0, -0.4f, 0}, 0.4f}, builder.add(DielectricDescription{1.5f}));
  builder.look({0, 0, 1.4}, {0, -0.5, 0});
  return builder;
}

// A small lamp over a metal plate in a room.
SceneBuilder metal_plate(float alpha, float lamp_side) {
  SceneBuilder builder;
  builder.shape(cube(Transform::scale(1.5, 1, 1.5)), builder.diffuse(0.4f), 0, true);
  builder.lamp_down(0, 0.99f, 0, lamp_side, lamp_side, builder.diffuse(0), 1 / (lamp_side * lamp_side));
  RoughConductorDescription metal{{.perfect = true}, {.alpha_u = alpha, .alpha_v = alpha}};
  builder.floor(-0.8f, 0.5f, builder.add(metal));
  builder.look({0, 0, 1.4}, {0, -0.3, 0});
  return builder;
}

Method pilot(const Scene& scene, const Goal& goal, int threads = 1, std::uint64_t seed = 3) {
  return make_method("auto", scene, {kFrame, seed, goal}, threads, kNever);
}

const MethodCandidate& candidate(const Method& method, const std::string& name) {
  return *std::ranges::find(method.choice->candidates, name, &MethodCandidate::method);
}

constexpr Goal kFivePercent{{}, {}, 0.05};

TEST(Pilot, CachesIrradianceOfAWhiteRoom) {
  const Scene scene(in_frame(white_room()), 1);
  const Method method = pilot(scene, kFivePercent);
  EXPECT_STREQ(method.integrator->name(), "irradiance-cache") << method.choice->reason;
  EXPECT_EQ(candidate(method, "photon-progressive").reason, "no light reaches a surface by mirrors, glass or gloss");
}

// All light of the picture is in the specular layer, and as indirect as without the pane.
TEST(Pilot, TriesACacheWhereTheRoomIsSeenThroughGlass) {
  SceneBuilder builder = white_room();
  builder.shape(cube(Transform::translate(0, 0, 1.2) * Transform::scale(1.4, 0.9, 0.02)), builder.add(DielectricDescription{1.5f}));
  const Scene scene(in_frame(builder), 1);
  EXPECT_TRUE(candidate(pilot(scene, kFivePercent), "irradiance-cache").trial);
}

TEST(Pilot, TracesPathsWhereNothingIsIndirectAndTriesNoCache) {
  const Scene scene(in_frame(lit_plane()), 1);
  const Method method = pilot(scene, kFivePercent);
  EXPECT_STREQ(method.integrator->name(), "path") << method.choice->reason;
  EXPECT_FALSE(candidate(method, "irradiance-cache").trial);
  EXPECT_EQ(candidate(method, "irradiance-cache").reason.find("indirect light makes 0 % of the noise"), 0u);
}

TEST(Pilot, ShootsPhotonsOrCachesWithThemUnderASmallLampOverGlass) {
  const Scene scene(in_frame(glass_ball()), 1);
  const Method method = pilot(scene, kFivePercent);
  EXPECT_TRUE(method.integrator->finds_caustics()) << method.choice->reason;
  // What paths have not met of the caustic counts: they would take many times as much, not the little that they saw.
  const MethodCandidate& path = candidate(method, "path");
  EXPECT_GT(path.forecast->work, 5 * candidate(method, method.choice->method).forecast->work);
}

// Nearly no path of its samples has met the lamp in the plate: what that will do is told by the side of the light.
TEST(Pilot, ShootsPhotonsWhereASmoothPlateReflectsASmallLamp) {
  const Scene scene(in_frame(metal_plate(0.01f, 0.05f)), 1);
  const Method method = pilot(scene, kFivePercent);
  EXPECT_TRUE(method.integrator->finds_caustics()) << method.choice->reason;
  const MethodCandidate& path = candidate(method, "path");
  EXPECT_GT(path.forecast->work, 2 * candidate(method, method.choice->method).forecast->work);
}

TEST(Pilot, TriesNoPhotonsWhereALargeLampShinesOnARoughPlate) {
  const Scene scene(in_frame(metal_plate(0.4f, 1)), 1);
  const Method method = pilot(scene, kFivePercent);
  EXPECT_FALSE(method.integrator->finds_caustics()) << method.choice->reason;
  EXPECT_EQ(candidate(method, "photon-progressive").reason.find("light from mirrors and gloss makes too little of the noise"), 0u);
}

TEST(Pilot, LooksLongerWhereMoreIsAtStake) {
  const Scene scene(in_frame(lit_plane()), 1);
  const Method hasty = pilot(scene, {{}, {}, 0.2}), careful = pilot(scene, {{}, {}, 0.0005});
  EXPECT_EQ(candidate(hasty, "path").trial->samples, 8);
  EXPECT_EQ(candidate(careful, "path").trial->samples, 64);
  EXPECT_NE(careful.known.tile(3, {32, 64}, {0, 0, 32, 32}), nullptr);
}

TEST(Pilot, LeavesPathsOutWhereTheyMissAPointLampThroughGlass) {
  SceneBuilder builder;
  builder.shape(cube(Transform::scale(1.5, 1, 1.5)), builder.diffuse(0.6f), 0, true);
  builder.shape(SphereDescription{{0, 0.4f, 0}, 0.2f}, builder.add(DielectricDescription{1.5f}));
  builder.emitter(PointEmitterDescription{{0, 0.4f, 0}, Rgb{1}});
  builder.look({0, 0, 1.4}, {0, -0.5, 0});
  const Scene scene(in_frame(builder), 1);
  const Method method = pilot(scene, kFivePercent);
  EXPECT_TRUE(method.integrator->finds_caustics());
  EXPECT_FALSE(candidate(method, "path").forecast);
  EXPECT_EQ(candidate(method, "path").reason.find("no path finds the light of point lamps"), 0u);
}

TEST(Pilot, SaysWhyAMethodDoesNotSuitFog) {
  SceneBuilder builder = white_room();
  const int fog = builder.medium({.sigma_t = Rgb{0.3f}});
  builder.interior(fog).camera_in(fog);
  const Scene scene(in_frame(builder), 1);
  const Method method = pilot(scene, kFivePercent);
  EXPECT_STREQ(method.integrator->name(), "path");
  EXPECT_NE(candidate(method, "irradiance-cache").reason.find("participating media"), std::string::npos);
}

TEST(Pilot, TriesNothingWherePathsAloneSuitAndSamplesAreGiven) {
  SceneBuilder builder;
  builder.shape(SphereDescription{{0, 0, 0}, 1}, builder.add(DielectricDescription{1.5f}));
  builder.emitter(ConstantEmitterDescription{Rgb{1}});
  builder.look({0, 0, 4}, {0, 0, 0});
  const Scene scene(in_frame(builder), 1);
  const Method method = pilot(scene, {64, {}, {}});
  EXPECT_STREQ(method.integrator->name(), "path");
  EXPECT_FALSE(candidate(method, "path").trial);
  EXPECT_EQ(method.known.tile(3, {0, 1}, {0, 0, 32, 32}), nullptr);
}

TEST(Pilot, ChoosesTheSameForAnyNumberOfThreads) {
  for (const SceneBuilder& builder : {white_room(), lit_plane(), glass_ball()}) {
    const Scene scene(in_frame(builder), 1);
    for (const Goal& goal : {kFivePercent, Goal{64, {}, {}}}) {
      const Method one = pilot(scene, goal, 1), three = pilot(scene, goal, 3);
      EXPECT_EQ(one.choice->method, three.choice->method);
      EXPECT_EQ(one.choice->reason, three.choice->reason);
    }
  }
}

TEST(Pilot, ItsSamplesAreThoseOfThePicture) {
  for (const SceneBuilder& builder : {white_room(), lit_plane(), glass_ball()}) {
    const Scene scene(in_frame(builder), 1);
    const Goal goal{{}, {}, 5.0};  // met by the first round
    const Method method = pilot(scene, goal);
    const FrameSettings settings{kFrame, 32, 2, 3, goal};
    const FrameResult with = render_frame(scene, *method.integrator, settings, kNever, {}, method.known);
    const auto alone = make_integrator(method.choice->method, scene);
    const FrameResult without = render_frame(scene, *alone, settings, kNever);
    const Image a = with.film.image(kFrame, {}), b = without.film.image(kFrame, {});
    for (std::size_t c = 0; c < a.channels.size(); ++c) EXPECT_EQ(a.channels[c].values, b.channels[c].values) << a.channels[c].name;
    EXPECT_LT(with.rays, without.rays);
    // Of another seed they are not.
    EXPECT_EQ(method.known.tile(4, {0, 1}, {0, 0, 32, 32}), nullptr);
    EXPECT_FALSE(method.known.pass(4, {0, 1}));
  }
}

TEST(Pilot, StopsWhenItIsCancelled) {
  const Scene scene(in_frame(white_room()), 1);
  const std::atomic<bool> cancelled{true};
  EXPECT_THROW(make_method("auto", scene, {kFrame, 3, kFivePercent}, 1, cancelled), CancelledError);
}

TEST(PilotTiles, AreDifferentOnesAllOverTheCrop) {
  for (const PixelRect crop :
       {PixelRect{0, 0, 640, 480}, PixelRect{7, 5, 100, 70}, PixelRect{0, 0, 20, 10}, PixelRect{0, 0, 4000, 32}}) {
    const std::vector<PixelRect> tiles = pilot_tiles(crop);
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      EXPECT_TRUE(crop.contains(tiles[i]));
      EXPECT_EQ((tiles[i].x - crop.x) % 32, 0);
      EXPECT_EQ(std::ranges::count(tiles, tiles[i]), 1);
    }
  }
  const std::vector<PixelRect> tiles = pilot_tiles({0, 0, 640, 480});
  EXPECT_EQ(tiles.size(), 30u);  // of 300
  for (const PixelRect quarter : {PixelRect{0, 0, 320, 240}, {320, 0, 320, 240}, {0, 240, 320, 240}, {320, 240, 320, 240}}) {
    EXPECT_GE(std::ranges::count_if(tiles, [&](const PixelRect& tile) { return quarter.contains(tile); }), 5);
  }
  EXPECT_EQ(pilot_tiles({0, 0, 20, 10}).size(), 1u);
}

}  // namespace
}  // namespace fluxfarm
