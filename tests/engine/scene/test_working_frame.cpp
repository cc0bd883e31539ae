// Scenes that are small, or far from the origin, look as they would elsewhere.
#include <gtest/gtest.h>

#include "scene/working_frame.h"
#include "support/error.h"
#include "support/scene_builder.h"

namespace fluxfarm::testing {
namespace {

// A floor of albedo 0.5, 2 x `size` wide, under a point light of `size`^2 W/sr at the height `size`, seen from beside the light.
SceneBuilder lit_floor(double size, double shift) {
  SceneBuilder scene;
  const Transform to_world =
      Transform::translate(shift, shift, shift) * Transform::rotate(1, 0, 0, -90) * Transform::scale(size, size, 1);
  scene.shape(RectangleDescription{to_world}, scene.diffuse(0.5f));
  const auto at = [&](double value) { return static_cast<float>(shift + size * value); };
  scene.emitter(PointEmitterDescription{{at(0), at(1), at(0)}, Rgb{static_cast<float>(size * size)}});
  scene.look({shift + 0.3 * size, shift + size, shift}, {shift, shift, shift});
  return scene.near_clip(static_cast<float>(1e-3 * size));
}

constexpr double kRadiance = 0.5 / 3.141592653589793;  // D1: E = I / h^2 = 1

TEST(WorkingFrame, KeepsThePictureOfSmallAndOfDistantScenes) {
  for (const double size : {1e-7, 1e-4, 1e-2, 1.0}) {
    EXPECT_NEAR(measure(lit_floor(size, 0).description(), 8).mean, kRadiance, 1e-3 * kRadiance) << size;
  }
  EXPECT_NEAR(measure(lit_floor(1, 1 << 20).description(), 8).mean, kRadiance, 1e-3 * kRadiance);
  // Twin: light that was not enlarged with the scene, by 2^14.
  SceneDescription dim = lit_floor(1e-4, 0).description();
  std::get<PointEmitterDescription>(dim.emitters[0]).intensity *= 0x1p-28f;
  EXPECT_LT(measure(dim, 8).mean, 1e-3 * kRadiance);
}

// Through fog of an optical depth of one on the way from the camera to a lamp.
TEST(WorkingFrame, KeepsTheOpticalDepthOfMedia) {
  for (const float size : {1e-5f, 1.0f}) {
    SceneBuilder scene;
    const double half = static_cast<double>(size);
    scene.shape(RectangleDescription{Transform::scale(half, half, 1)}, scene.diffuse(0), 1);
    scene.camera_in(scene.medium({.sigma_t = Rgb{1 / size}, .albedo = Rgb{0}})).near_clip(1e-6f * size);
    scene.look({0, 0, half}, {0, 0, 0});
    EXPECT_NEAR(measure(scene.description(), 64).mean, std::exp(-1), 1e-3) << size;
  }
}

TEST(WorkingFrame, TellsDepthsInMetresOfTheFile) {
  const SceneDescription small = lit_floor(1e-3, 0).description();
  const WorkingDescription working(small);
  EXPECT_LT(working.get().camera.unit, 1e-3f);
  const Scene scene(small, 1);
  const Camera& camera = scene.camera();
  const Ray ray = camera.ray(2, 2);
  EXPECT_NEAR(camera.depth(ray.origin + 1.0f * ray.direction), working.get().camera.unit, 1e-6f * working.get().camera.unit);
}

TEST(WorkingFrame, LeavesOtherScenesAlone) {
  const SceneDescription usual = lit_floor(1, 3).description(), large = lit_floor(1e5, 0).description();
  EXPECT_EQ(&WorkingDescription(usual).get(), &usual);
  EXPECT_EQ(&WorkingDescription(large).get(), &large);
}

TEST(WorkingFrame, WarnsWherePlacesAreRounded) {
  const auto warnings = [](double shift) { return Scene(lit_floor(1, shift).description(), 1).warnings(); };
  EXPECT_TRUE(warnings(100).empty());
  ASSERT_EQ(warnings(1e6).size(), 1u);
  EXPECT_NE(warnings(1e6)[0].find("rounded by up to 0.0596047 m"), std::string::npos) << warnings(1e6)[0];
}

// A small scene on a large plain is not enlarged; its near plane tells that it is there.
TEST(WorkingFrame, WarnsOfSmallPlacesInLargeScenes) {
  const auto warnings = [](double size) {
    SceneBuilder scene = lit_floor(size, 0);
    return Scene(scene.floor(-1, 1000, scene.diffuse(0.5f)).description(), 1).warnings();
  };
  EXPECT_TRUE(warnings(0.1).empty());
  ASSERT_EQ(warnings(1e-4).size(), 1u);
  EXPECT_EQ(warnings(1e-4)[0].find("the sensor's near_clip = 1e-07 m is far below the 1.52588e-05 m"), 0u) << warnings(1e-4)[0];
}

TEST(WorkingFrame, RefusesWhatIsTooSmall) {
  try {
    const WorkingDescription working(lit_floor(1e-11, 0).description());
    FAIL();
  } catch (const SceneError& error) {
    EXPECT_NE(std::string(error.what()).find("expected at least 1e-09"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace fluxfarm::testing
