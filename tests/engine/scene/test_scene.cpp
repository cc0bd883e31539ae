// Camera geometry, which side of a surface shines and scatters, and what the census says.
#include <gtest/gtest.h>

#include "scene/scene.h"
#include "support/error.h"
#include "support/scene_builder.h"
#include "support/sky.h"

namespace fluxfarm::testing {
namespace {

CameraDescription camera_of(float degrees, CameraDescription::FovAxis axis) {
  CameraDescription camera;
  camera.to_world = Transform::look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0});
  camera.fov_degrees = degrees;
  camera.fov_axis = axis;
  return camera;
}

TEST(Camera, FieldOfViewIsMeasuredAlongItsAxis) {
  using Axis = CameraDescription::FovAxis;
  // 200 x 100 pixels, 90 degrees: the tangent of half the angle is one along the named axis.
  const auto edge = [](Axis axis) { return Camera(camera_of(90, axis), 200, 100).ray(0, 50).direction; };
  const auto slope = [](Vec3f d) { return std::fabs(d.x / d.z); };
  EXPECT_NEAR(slope(edge(Axis::kX)), 1, 1e-5f);
  EXPECT_NEAR(slope(edge(Axis::kY)), 2, 1e-5f);
  EXPECT_NEAR(slope(edge(Axis::kSmaller)), 2, 1e-5f);
  EXPECT_NEAR(slope(edge(Axis::kLarger)), 1, 1e-5f);
  EXPECT_NEAR(slope(edge(Axis::kDiagonal)), 2 / std::sqrt(5.0f), 1e-5f);
}

TEST(Camera, FilmRunsFromTopLeftAndLeftIsPlusX) {
  const Camera camera(camera_of(90, CameraDescription::FovAxis::kX), 100, 100);
  const Vec3f top_left = camera.ray(0, 0).direction;
  EXPECT_GT(top_left.x, 0);
  EXPECT_GT(top_left.y, 0);
  EXPECT_NEAR(camera.ray(50, 50).direction.z, 1, 1e-6f);
}

TEST(Camera, NearAndFarPlanesAreDistancesAlongTheAxis) {
  CameraDescription description = camera_of(90, CameraDescription::FovAxis::kX);
  description.near_clip = 2;
  description.far_clip = 10;
  const Camera camera(description, 100, 100);
  const Ray ray = camera.ray(0, 50);
  EXPECT_NEAR(camera.depth(ray.origin + ray.t_min * ray.direction), 2, 1e-5f);
  EXPECT_NEAR(camera.depth(ray.origin + ray.t_max * ray.direction), 10, 1e-4f);
}

TEST(Camera, RaysThroughALensMeetInThePlaneInFocus) {
  CameraDescription description = camera_of(90, CameraDescription::FovAxis::kX);
  description.near_clip = 2;
  description.far_clip = 10;
  description.aperture_radius = 0.3f;
  description.focus_distance = 4;
  const Camera camera(description, 100, 100);
  ASSERT_TRUE(camera.has_lens());
  for (const Vec2f u : {Vec2f{0.1f, 0.8f}, Vec2f{0.9f, 0.3f}, Vec2f{0.5f, 0.5f}}) {
    const Ray ray = camera.ray(0, 50, u);
    EXPECT_LE(length(ray.origin), 0.3f);
    EXPECT_NEAR(ray.origin.z, 0, 1e-6f);
    EXPECT_NEAR(length(ray.direction), 1, 1e-6f);
    const Vec3f focus = ray.origin + (4 / ray.direction.z) * ray.direction;
    EXPECT_NEAR(length(focus - Vec3f{4, 0, 4}), 0, 1e-5f);
    EXPECT_NEAR(camera.depth(ray.origin + ray.t_min * ray.direction), 2, 1e-5f);
    EXPECT_NEAR(camera.depth(ray.origin + ray.t_max * ray.direction), 10, 1e-4f);
  }
}

// A disk of radius r at distance z on the axis of a lens of radius R that is focused at f fills the part (r / (R |1 - z / f|))^2 of
// the lens. Two-sided z-test at a level of 1e-3.
TEST(Camera, BlurHasTheSizeOfTheCircleOfConfusion) {
  const auto seen = [](float focus_distance) {
    SceneBuilder scene;
    scene.shape(DiskDescription{Transform::translate(0, 0, 1) * Transform::rotate(0, 1, 0, 180) * Transform::scale(0.02, 0.02, 1)},
                scene.diffuse(0), 1);
    scene.look({0, 0, 0}, {0, 0, 1});
    SceneDescription description = scene.description();
    description.camera.aperture_radius = 0.1f;
    description.camera.focus_distance = focus_distance;
    return measure(description, 1024);
  };
  EXPECT_NEAR(seen(1).mean, 1, 1e-6) << "sharp";
  const Measurement blurred = seen(2);
  EXPECT_LE(blurred.standard_error, 0.002);
  EXPECT_LE(blurred.z(0.16), 3.29) << blurred.mean;
  EXPECT_GT(blurred.z(0.4), 3.29) << "a lens sampled evenly in its radius is told apart";
}

// The radiance of what the camera sees head-on: a square at z = 1 whose front looks towards the camera, or away.
double radiance_seen(MaterialDescription material, float emitted, bool towards_camera) {
  SceneBuilder scene;
  const Transform turn = towards_camera ? Transform::rotate(0, 1, 0, 180) : Transform();
  scene.shape(RectangleDescription{Transform::translate(0, 0, 1) * turn}, scene.add(material), emitted);
  scene.emitter(ConstantEmitterDescription{Rgb{1.0f}});
  scene.look({0, 0, 0}, {0, 0, 1});
  return measure(scene.description(), 64).mean;
}

TEST(Sides, DiffuseIsBlackOnItsBackUnlessTwosided) {
  EXPECT_NEAR(radiance_seen(DiffuseDescription{Rgb{0.5f}}, 0, true), 0.5, 1e-5);
  EXPECT_EQ(radiance_seen(DiffuseDescription{Rgb{0.5f}}, 0, false), 0);
  SceneBuilder scene;
  const int front = scene.diffuse(0.25f), back = scene.diffuse(0.75f);
  scene.shape(RectangleDescription{Transform::translate(0, 0, 1)}, scene.add(TwosidedDescription{front, back}));
  scene.emitter(ConstantEmitterDescription{Rgb{1.0f}});
  scene.look({0, 0, 0}, {0, 0, 1});
  EXPECT_NEAR(measure(scene.description(), 64).mean, 0.75, 1e-5) << "the camera is behind: the back's material answers";
}

TEST(Sides, AreaEmittersShineFromTheirFrontOnly) {
  EXPECT_NEAR(radiance_seen(DiffuseDescription{Rgb{0.0f}}, 3, true), 3, 1e-6);
  EXPECT_EQ(radiance_seen(DiffuseDescription{Rgb{0.0f}}, 3, false), 0);
}

TEST(Sides, FlipNormalsSwapsFrontAndBack) {
  SceneBuilder scene;
  scene.shape(RectangleDescription{Transform::translate(0, 0, 1)}, scene.diffuse(0), 3, true);
  scene.look({0, 0, 0}, {0, 0, 1});
  EXPECT_NEAR(measure(scene.description(), 8).mean, 3, 1e-6);
}

TEST(Sides, GlassOfIndexOneIsNotThere) {
  EXPECT_NEAR(radiance_seen(DielectricDescription{.eta = 1}, 0, true), 1, 1e-5);
  EXPECT_NEAR(radiance_seen(DielectricDescription{.eta = 1}, 0, false), 1, 1e-5);
}

// Colours of the quarters of a textured square around the origin of the plane z = 1, seen at (x, y) from the origin: a white
// environment shows the reflectance. `back` turns the square's back to the camera.
class TexturedSquare {
 public:
  explicit TexturedSquare(bool back) : back_(back) {}

  double seen_at(double x, double y) const {
    SceneBuilder scene;
    const int board = scene.texture(CheckerboardDescription{Rgb{0.8f}, Rgb{0.2f}, {}});
    const int textured = scene.add(DiffuseDescription{Rgb{1.0f}, board}), plain = scene.diffuse(0.5f);
    const int both = scene.add(back_ ? TwosidedDescription{plain, textured} : TwosidedDescription{textured, plain});
    const Transform turn = back_ ? Transform() : Transform::rotate(0, 1, 0, 180);
    scene.shape(RectangleDescription{Transform::translate(0, 0, 1) * turn}, both);
    scene.emitter(ConstantEmitterDescription{Rgb{1.0f}});
    scene.look({x, y, 0}, {x, y, 1});
    return measure(scene.description(), 16).mean;
  }

 private:
  bool back_;
};

TEST(Textures, ShowTheirColoursWhereTheyLie) {
  const TexturedSquare front(false), back(true);
  EXPECT_NEAR(back.seen_at(-0.5, -0.5), 0.8, 1e-5);
  EXPECT_NEAR(back.seen_at(0.5, 0.5), 0.8, 1e-5);
  EXPECT_NEAR(back.seen_at(0.5, -0.5), 0.2, 1e-5);
  EXPECT_NEAR(back.seen_at(-0.5, 0.5), 0.2, 1e-5);
  EXPECT_NEAR(front.seen_at(0.5, -0.5), 0.8, 1e-5) << "turned about y: u runs against x";
  EXPECT_NEAR(front.seen_at(0.5, 0.5), 0.2, 1e-5);
}

TEST(Textures, StayOnTheirSideOfATwosidedMaterial) {
  SceneBuilder scene;
  const int board = scene.texture(CheckerboardDescription{Rgb{0.8f}, Rgb{0.2f}, {}});
  const int textured = scene.add(DiffuseDescription{Rgb{1.0f}, board}), plain = scene.diffuse(0.5f);
  scene.shape(RectangleDescription{Transform::translate(0, 0, 1)}, scene.add(TwosidedDescription{textured, plain}));
  scene.emitter(ConstantEmitterDescription{Rgb{1.0f}});
  scene.look({0.5, 0.5, 0}, {0.5, 0.5, 1});
  EXPECT_NEAR(measure(scene.description(), 16).mean, 0.5, 1e-5) << "the camera sees the back";
}

// Every pixel of a frame of textured surfaces, rendered in tiles of that side.
std::vector<float> textured_frame(int tile_size, int threads) {
  SceneBuilder builder;
  const int board =
      builder.texture(CheckerboardDescription{Rgb{0.8f, 0.3f, 0.1f}, Rgb{0.1f, 0.2f, 0.7f}, Transform::scale(4, 3, 1)});
  PlasticDescription paint;
  paint.diffuse_reflectance = Rgb{1.0f};
  paint.diffuse_reflectance_texture = board;
  builder.floor(-1, 3, builder.add(DiffuseDescription{Rgb{1.0f}, board}));
  builder.shape(SphereDescription{}, builder.add(RoughPlasticDescription{paint, {}}));
  builder.emitter(ConstantEmitterDescription{Rgb{1.0f}}).emitter(PointEmitterDescription{{1, 4, 2}, Rgb{9.0f}});
  builder.look({0, 1, 5}, {0, 0, 0});
  SceneDescription description = builder.description();
  description.camera.fov_degrees = 40;
  description.film.width = 48;
  description.film.height = 32;
  const Scene scene(description, 1);
  const auto integrator = make_integrator("path", scene);
  const std::atomic<bool> never{false};
  const FrameResult result = render_frame(scene, *integrator, {{0, 0, 48, 32}, tile_size, threads, 1, {8, {}, {}}}, never);
  std::vector<float> values;
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 48; ++x) {
      const Rgb mean = result.film.replicate_mean(x, y, 0);
      values.insert(values.end(), {mean.r, mean.g, mean.b});
    }
  }
  return values;
}

TEST(Textures, GiveTheSameBitsForAnyTileSizeAndNumberOfThreads) {
  const std::vector<float> expected = textured_frame(64, 1);
  EXPECT_EQ(textured_frame(7, 1), expected);
  EXPECT_EQ(textured_frame(16, 3), expected);
}

TEST(Textures, OnMeshesWithoutCoordinatesAreWarnedAbout) {
  SceneBuilder builder;
  const int board = builder.texture(CheckerboardDescription{});
  builder.shape(cube(Transform()), builder.add(DiffuseDescription{Rgb{1.0f}, board})).look({0, 0, -5}, {0, 0, 0});
  const Scene scene(builder.description(), 1);
  ASSERT_EQ(scene.warnings().size(), 1u);
  EXPECT_EQ(scene.warnings()[0], "test shape: the mesh has no texture coordinates; its texture fills every triangle by itself");
  EXPECT_EQ(scene.census().textures, 1u);
}

TEST(Census, CountsWhatIsThere) {
  SceneBuilder builder;
  builder.shape(cube(Transform()), builder.diffuse(0.5f));
  builder.shape(SphereDescription{{0, 3, 0}, 1}, builder.diffuse(0), 2);
  builder.emitter(PointEmitterDescription{{0, 9, 0}, Rgb{1.0f}});
  builder.emitter(SpotEmitterDescription{});
  builder.emitter(DirectionalEmitterDescription{});
  builder.emitter(EnvmapEmitterDescription{even_sky(1), Transform()});
  builder.look({0, 0, -5}, {0, 0, 0});
  const Scene scene(builder.description(), 1);
  EXPECT_EQ(scene.census().shapes, 2u);
  EXPECT_EQ(scene.census().triangles, 12u);
  EXPECT_EQ(scene.census().area_emitters, 1u);
  EXPECT_EQ(scene.census().point_emitters, 1u);
  EXPECT_EQ(scene.census().spot_emitters, 1u);
  EXPECT_EQ(scene.census().directional_emitters, 1u);
  EXPECT_TRUE(scene.census().environment_map);
  EXPECT_FALSE(scene.census().environment);
  EXPECT_FALSE(scene.census().anisotropic_materials);
  EXPECT_EQ(scene.census().textures, 0u);
}

TEST(Instances, AreCountedOnceAndNeverLights) {
  testing::SceneBuilder builder;
  const int grey = builder.diffuse(0.5f);
  const auto shared = std::make_shared<const MeshDescription>(testing::cube(Transform()));
  for (const double x : {0.0, 3.0, 6.0}) builder.shape(InstanceDescription{shared, Transform::translate(x, 0, 0)}, grey);
  const Scene scene(builder.description(), 1);
  EXPECT_EQ(scene.census().instances, 3u);
  EXPECT_EQ(scene.census().triangles, 12u);
  EXPECT_EQ(scene.census().shapes, 3u);
  Hit hit;
  ASSERT_TRUE(scene.accelerator().intersect({{3, 0, 9}, {0, 0, -1}}, hit));
  EXPECT_EQ(hit.shape, 1u);
  builder.shape(InstanceDescription{shared, Transform()}, grey, 1);
  EXPECT_THROW(Scene(builder.description(), 1), SceneError);
}

TEST(AreaEmitter, ShinesOnBothSidesOnlyIfToldSo) {
  const Rectangle lamp({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, false);
  const AreaEmitter one(lamp, Rgb{2}), both(lamp, Rgb{2}, true);
  for (const float z : {3.0f, -3.0f}) {
    const auto light = both.sample({0, 0, z}, {0.3f, 0.7f});
    ASSERT_TRUE(light);
    EXPECT_GT(light->normal.z * z, 0);  // towards the reference, so that a shadow ray ends on its side
    EXPECT_EQ(one.sample({0, 0, z}, {0.3f, 0.7f}).has_value(), z > 0);
    SurfacePoint point;
    point.geometric_normal = {0, 0, 1};
    EXPECT_EQ(both.radiance(point, {0, 0, z > 0 ? -1.0f : 1.0f}), Rgb{2});
    EXPECT_EQ(one.radiance(point, {0, 0, z > 0 ? -1.0f : 1.0f}), z > 0 ? Rgb{2} : Rgb{});
  }
  EXPECT_FLOAT_EQ(both.power().r, 2 * one.power().r);
}

// Embree would end the program.
TEST(BadScene, LiesFartherAwayThanRaysReach) {
  const auto refused = [](SceneBuilder builder, const std::array<double, 3>& eye = {0, 0, 1}) -> std::string {
    try {
      const Scene scene(builder.look(eye, {0, 0, 0}).description(), 1);
    } catch (const SceneError& error) {
      return error.what();
    }
    return "";
  };
  const auto ball = [](float x) {
    SceneBuilder builder;
    return builder.shape(SphereDescription{{x, 0, 0}, 1}, builder.diffuse(1));
  };
  const std::string expected = " is 1e+18 m from the origin, expected at most 1e+17";
  EXPECT_EQ(refused(ball(1e16f)), "");
  EXPECT_EQ(refused(ball(-1e18f)), "test shape:" + expected);
  EXPECT_EQ(refused(ball(0), {0, 0, 1e18}), "the sensor:" + expected);
  EXPECT_EQ(refused(ball(0).near_clip(1e18f)), "the sensor:" + expected);
  EXPECT_EQ(refused(ball(0).emitter(PointEmitterDescription{{0, 1e18f, 0}})), "a point emitter:" + expected);
  EXPECT_EQ(refused(ball(0).emitter(SpotEmitterDescription{{0, 0, -1e18f}})), "a spot emitter:" + expected);
}

}  // namespace
}  // namespace fluxfarm::testing
