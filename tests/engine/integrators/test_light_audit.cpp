// The light-side audit estimates the same picture as path tracing, for light that both can find. Each case has a twin: the estimate
// of an audit with a fault, which the same test rejects.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "film/error_goal.h"
#include "film/tile_grid.h"
#include "integrators/audit/light_audit.h"
#include "support/error.h"
#include "support/scene_builder.h"
#include "support/sky.h"
#include "worker/loaded_scene.h"

namespace fluxfarm {
namespace {

using testing::SceneBuilder;

const std::atomic<bool> kNever{false};
constexpr int kSide = 64;
constexpr PixelRect kFrame{0, 0, kSide, kSide};

// The builder's scene seen by a camera with a wide view of four cells.
SceneDescription wide_view(const SceneBuilder& builder, float fov_degrees) {
  SceneDescription scene = builder.description();
  scene.camera.fov_degrees = fov_degrees;
  scene.film.width = scene.film.height = kSide;
  return scene;
}

struct Side {
  std::vector<double> radiance, variance, unreachable;  // of each cell
  double share = 0;
};

// Mean of audits with different seeds.
Side light_side(const SceneDescription& description, int audits) {
  const Scene scene(description, 1);
  Side side;
  for (int seed = 0; seed < audits; ++seed) {
    const LightAudit audit = audit_light(scene, kFrame, static_cast<std::uint64_t>(seed), 2, kNever);
    side.radiance.resize(audit.cells.size());
    side.variance.resize(audit.cells.size());
    side.unreachable.resize(audit.cells.size());
    for (std::size_t i = 0; i < audit.cells.size(); ++i) {
      side.radiance[i] += audit.cells[i].radiance / audits;
      side.variance[i] += audit.cells[i].variance / (audits * audits);
      side.unreachable[i] += audit.cells[i].unreachable / audits;
    }
    side.share += audit.unreachable_share / audits;
  }
  return side;
}

Side camera_side(const SceneDescription& description, std::uint32_t spp) {
  const Scene scene(description, 1);
  const auto integrator = make_integrator("path", scene);
  const FrameResult result = render_frame(scene, *integrator, {kFrame, 64, 2, 1, {spp, {}, {}}}, kNever);
  Side side;
  for (const PixelRect& cell : make_tiles(kFrame, kErrorTile)) {
    double radiance = 0, variance = 0;
    for (int y = cell.y; y < cell.y + cell.height; ++y) {
      for (int x = cell.x; x < cell.x + cell.width; ++x) {
        const PixelEstimate pixel = result.film.estimate(x, y);
        radiance += (pixel.mean[0] + pixel.mean[1] + pixel.mean[2]) / 3;
        variance += std::pow(static_cast<double>(pixel.standard_error[1]), 2);
      }
    }
    side.radiance.push_back(radiance / cell.pixels());
    side.variance.push_back(variance / (cell.pixels() * cell.pixels()));
  }
  return side;
}

// Largest deviation of a cell, and of the sum over the cells, in standard errors, if the light side is multiplied by `factor`.
double worst_z(const Side& light, const Side& camera, double factor = 1) {
  double worst = 0, difference = 0, variance = 0;
  for (std::size_t i = 0; i < light.radiance.size(); ++i) {
    const double d = factor * light.radiance[i] - camera.radiance[i], v = light.variance[i] + camera.variance[i];
    worst = std::max(worst, std::abs(d) / std::sqrt(v));
    difference += d;
    variance += v;
  }
  return std::max(worst, std::abs(difference) / std::sqrt(variance));
}

// Five standard errors: a right audit fails once in 300,000 cases. The twin is off by 4 %, as an audit is that loses the light of
// one surface in 25.
void expect_same_light(const SceneDescription& scene, int audits = 96, std::uint32_t spp = 256) {
  const Side light = light_side(scene, audits), camera = camera_side(scene, spp);
  for (std::size_t i = 0; i < light.radiance.size(); ++i) {
    EXPECT_NEAR(light.radiance[i] / camera.radiance[i], 1, 0.05) << "cell " << i;
  }
  EXPECT_LT(worst_z(light, camera), 5);
  EXPECT_GT(worst_z(light, camera, 1.04), 5) << "the comparison is too weak to see 4 %";
}

// A floor with a block on it, seen from above at an angle.
SceneBuilder block_on_floor() {
  SceneBuilder builder;
  const int grey = builder.diffuse(0.6f);
  builder.floor(0, 3, grey);
  builder.shape(testing::cube(Transform::translate(0.2, 0.25, 0.1) * Transform::scale(0.25, 0.25, 0.25)), grey);
  builder.look({0.3, 2.2, 1.5}, {0, 0, 0});
  return builder;
}

TEST(LightAudit, SeesThePointLightOfD1) {
  SceneBuilder builder;
  builder.floor(0, 2, builder.diffuse(0.5f)).emitter(PointEmitterDescription{{0, 1, 0}, Rgb{1}}).look({0, 2, 0}, {0, 0, 0});
  const SceneDescription scene = wide_view(builder, 40);
  // Mean over the frame of rho / pi I h / (h^2 + x^2)^1.5, h = 1, over the square that the camera sees.
  const double half = 2 * std::tan(20 * M_PI / 180);
  const auto mean_radiance = [&](double power) {
    constexpr int kSteps = 400;
    double sum = 0;
    for (int i = 0; i < kSteps * kSteps; ++i) {
      const double x = half * (2 * (i % kSteps + 0.5) / kSteps - 1), z = half * (2 * (i / kSteps + 0.5) / kSteps - 1);
      sum += 0.5 / M_PI * std::pow(1 + x * x + z * z, power) / (kSteps * kSteps);
    }
    return sum;
  };
  const Side light = light_side(scene, 64);
  const double mean = std::accumulate(light.radiance.begin(), light.radiance.end(), 0.0) / 4;
  const double error = std::sqrt(std::accumulate(light.variance.begin(), light.variance.end(), 0.0)) / 4;
  EXPECT_LT(error, 0.005 * mean);
  EXPECT_LT(std::abs(mean - mean_radiance(-1.5)), 4 * error);
  EXPECT_GT(std::abs(mean - mean_radiance(-1)), 4 * error) << "twin: the cosine at the floor left out";
  EXPECT_EQ(light.share, 0);
}

TEST(LightAudit, SeesTheLightOfEveryEmitter) {
  const Transform down = Transform::translate(-0.4, 1.2, 0.3) * Transform::rotate(1, 0.2, 0, 80);
  const auto with_lamp = [&](auto geometry, bool both_sides) {
    SceneBuilder builder = block_on_floor();
    builder.shape(geometry, builder.diffuse(0.0f), 3);
    SceneDescription scene = wide_view(builder, 35);
    scene.shapes.back().emits_on_both_sides = both_sides;
    return scene;
  };
  const auto with_emitter = [&](const EmitterDescription& emitter) {
    SceneBuilder builder = block_on_floor();
    builder.emitter(emitter);
    return wide_view(builder, 35);
  };
  // The lamps stand beside the view, which shows their light only.
  const Transform lamp = Transform::translate(-1.6, 0.8, 0.3) * Transform::rotate(0, 1, 0, 70) * Transform::scale(0.3, 0.3, 0.3);
  {
    SCOPED_TRACE("rectangle");
    expect_same_light(with_lamp(RectangleDescription{lamp}, false));
  }
  {
    SCOPED_TRACE("disk, both sides");
    expect_same_light(with_lamp(DiskDescription{lamp}, true));
  }
  {
    SCOPED_TRACE("sphere");
    expect_same_light(with_lamp(SphereDescription{{-1.6f, 0.8f, 0.3f}, 0.25f}, false));
  }
  {
    SCOPED_TRACE("mesh");
    expect_same_light(with_lamp(testing::cube(lamp), false));
  }
  {
    SCOPED_TRACE("point");
    expect_same_light(with_emitter(PointEmitterDescription{{-0.5f, 1, 0.4f}, Rgb{1}}));
  }
  {
    SCOPED_TRACE("spot");
    expect_same_light(with_emitter(SpotEmitterDescription{{-0.5f, 1.5f, 0.4f}, normalize(Vec3f{0.4f, -1, -0.2f}), Rgb{1}, 60, 20}));
  }
  {
    SCOPED_TRACE("directional");
    expect_same_light(with_emitter(DirectionalEmitterDescription{normalize(Vec3f{0.4f, -1, -0.2f}), Rgb{1}}));
  }
  {
    SCOPED_TRACE("environment map");
    expect_same_light(with_emitter(EnvmapEmitterDescription{testing::patchy_sky(16, 9), down}));
  }
}

// A closed room with a lamp outside the view.
SceneBuilder room(MaterialDescription block, float walls = 0.7f) {
  SceneBuilder builder;
  const int wall = builder.diffuse(walls);
  builder.shape(testing::cube(Transform::scale(1, 1, 1)), wall, 0, true);
  builder.lamp_down(0, 0.99f, 0.6f, 0.5f, 0.5f, builder.diffuse(0), 5);
  builder.shape(SphereDescription{{-0.1f, -0.6f, -0.4f}, 0.35f}, builder.add(std::move(block)));
  builder.look({0.2, -0.2, 0.9}, {0, -0.6, -0.6});
  return builder;
}

TEST(LightAudit, SeesInterreflection) { expect_same_light(wide_view(room(DiffuseDescription{Rgb{0.5f}}), 50), 24); }

TEST(LightAudit, SeesGlossySurfaces) {
  RoughConductorDescription metal;
  metal.conductor.perfect = true;
  metal.roughness.alpha_u = metal.roughness.alpha_v = 0.3f;
  expect_same_light(wide_view(room(metal), 50), 24);
}

// A smooth coat on a block beside the view: the audit is blind to what a camera sees in it, and not to the light that it throws.
TEST(LightAudit, FollowsCoatedSurfaces) {
  PlasticDescription coated;
  coated.diffuse_reflectance = Rgb{0.6f};
  SceneBuilder builder;
  builder.floor(0, 3, builder.diffuse(0.6f));
  builder.shape(testing::cube(Transform::translate(-1.5, 0.5, 0) * Transform::scale(0.1, 0.5, 1)), builder.add(coated));
  builder.shape(SphereDescription{{1.8f, 0.7f, 0}, 0.5f}, builder.diffuse(0), 2);
  builder.look({-0.4, 2.2, 0.1}, {-0.5, 0, 0});
  expect_same_light(wide_view(builder, 30), 240, 1024);
}

TEST(LightAudit, SeesThroughAThinLens) {
  SceneDescription scene = wide_view(room(DiffuseDescription{Rgb{0.5f}}), 50);
  scene.camera.aperture_radius = 0.05f;
  scene.camera.focus_distance = 0.8f;
  expect_same_light(scene, 24);
}

TEST(LightAudit, KeepsToTheLongestPath) {
  SceneBuilder builder = room(DiffuseDescription{Rgb{0.5f}});
  builder.max_depth(3);  // light that was reflected twice
  expect_same_light(wide_view(builder, 50), 24);
}

// Light from a large lamp under a slab of glass, which paths find, too: refraction gathers flux and not radiance.
TEST(LightAudit, FollowsRefraction) {
  SceneBuilder builder;
  builder.floor(0, 3, builder.diffuse(0.6f));
  builder.shape(
      testing::cube(Transform::translate(-1.3, 0.5, 0) * Transform::rotate(0, 0, 1, 20) * Transform::scale(0.1, 0.45, 0.6)),
      builder.add(DielectricDescription{}));
  builder.shape(SphereDescription{{-2.1f, 0.7f, 0}, 0.5f}, builder.diffuse(0), 2);
  builder.look({0.3, 2.2, 0.1}, {0, 0, 0});
  expect_same_light(wide_view(builder, 30), 192, 1024);
}

// Normals of the vertices: the cosines that light and camera see are not the same.
TEST(LightAudit, FollowsShadingNormals) {
  SceneBuilder builder;
  const int grey = builder.diffuse(0.8f);
  MeshDescription floor;
  floor.positions = {{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}};
  floor.normals.assign(4, normalize(Vec3f{0.5f, 1, 0}));
  floor.indices = {0, 1, 2, 0, 2, 3};
  builder.shape(floor, grey);
  // A wall that only the floor lights: the lamp shines down.
  builder.shape(
      RectangleDescription{Transform::translate(1.2, 0.9, 0) * Transform::rotate(0, 1, 0, -90) * Transform::scale(1, 0.5, 1)},
      grey);
  builder.lamp_down(-0.3f, 1.5f, 0, 0.4f, 0.4f, builder.diffuse(0), 5);
  builder.look({-0.4, 1.2, 0}, {1.2, 0.7, 0});
  expect_same_light(wide_view(builder, 35), 400, 512);
}

// A normal map on the floor, which alone lights the wall that is seen: not reciprocal, so that particles which
// take the weights of paths light it 37 % too much.
TEST(LightAudit, FollowsNormalMaps) {
  const auto scene = [](bool tilted) {
    SceneBuilder builder;
    const int grey = builder.diffuse(0.8f);
    const Vec3f n = normalize(Vec3f{0.7f, 0, 1});
    const Rgb colour = tilted ? Rgb{0.5f * (n.x + 1), 0.5f * (n.y + 1), 0.5f * (n.z + 1)} : Rgb{0.5f, 0.5f, 1};
    const int normals = builder.texture(CheckerboardDescription{colour, colour, {}});
    builder.floor(0, 1, builder.add(NormalMapDescription{grey, normals}));
    // A wall that only the floor lights: the lamp shines down.
    builder.shape(
        RectangleDescription{Transform::translate(1.2, 0.9, 0) * Transform::rotate(0, 1, 0, -90) * Transform::scale(1, 0.5, 1)},
        grey);
    builder.lamp_down(-0.3f, 1.5f, 0, 0.4f, 0.4f, builder.diffuse(0), 5);
    builder.look({-0.4, 1.2, 0}, {1.2, 0.7, 0});
    return wide_view(builder, 35);
  };
  expect_same_light(scene(true), 400, 512);
  // Twin: without the map the floor throws other light on the wall.
  EXPECT_GT(worst_z(light_side(scene(false), 24), camera_side(scene(true), 64)), 5);
}

TEST(LightAudit, FollowsRoughGlass) {
  RoughDielectricDescription rough;
  rough.roughness.alpha_u = rough.roughness.alpha_v = 0.3f;
  SceneBuilder builder;
  builder.floor(0, 3, builder.diffuse(0.6f));
  builder.shape(
      testing::cube(Transform::translate(-1.3, 0.5, 0) * Transform::rotate(0, 0, 1, 20) * Transform::scale(0.1, 0.45, 0.6)),
      builder.add(rough));
  builder.shape(SphereDescription{{-2.1f, 0.7f, 0}, 0.5f}, builder.diffuse(0), 2);
  builder.look({0.3, 2.2, 0.1}, {0, 0, 0});
  expect_same_light(wide_view(builder, 30), 320, 1536);
}

TEST(LightAudit, FindsTheLightOfABulbUnreachable) {
  const auto lamp_over_floor = [](bool bulb) {
    SceneBuilder builder;
    builder.floor(0, 3, builder.diffuse(0.5f)).emitter(PointEmitterDescription{{0, 1, 0}, Rgb{1}});
    if (bulb) builder.shape(SphereDescription{{0, 1, 0}, 0.2f}, builder.add(DielectricDescription{}));
    builder.look({2, 2, 0}, {1.2, 0, 0});
    return wide_view(builder, 35);
  };
  const Side closed = light_side(lamp_over_floor(true), 24), open = light_side(lamp_over_floor(false), 24);
  EXPECT_NEAR(closed.share, 1, 1e-12);
  EXPECT_EQ(open.share, 0);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(closed.radiance[i], 0);
    EXPECT_EQ(open.unreachable[i], 0);
    // Glass around a point bends none of its light; what it reflects passes later.
    EXPECT_NEAR(closed.unreachable[i] / open.radiance[i], 1, 0.04) << "cell " << i;
  }
}

// C8: a picture of a floor under a bulb. Nothing of it disagrees with itself, for paths find nothing at all.
TEST(LightAudit, KeepsABulbFromBeingClaimed) {
  SceneBuilder builder;
  builder.floor(0, 3, builder.diffuse(0.5f)).emitter(PointEmitterDescription{{0, 1, 0}, Rgb{1}});
  builder.shape(SphereDescription{{0, 1, 0}, 0.2f}, builder.add(DielectricDescription{}));
  builder.look({2, 2, 0}, {1.2, 0, 0});
  const Scene scene(wide_view(builder, 35), 1);
  const auto integrator = make_integrator("path", scene);
  const FrameResult result = render_frame(scene, *integrator, {kFrame, 64, 2, 1, {{}, {}, 0.1}}, kNever);
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_NE(result.warnings[0].find("about 100 % of the picture's light"), std::string::npos) << result.warnings[0];
  EXPECT_GT(result.error_unseen.value(), 0.1);
  EXPECT_GT(result.timeline.back().error_bound.value(), 0.1);
  // Twin: the same decision without the audit claims a black picture.
  const ErrorLook blind = look_at(result.film, {0.1}, 1);
  EXPECT_FALSE(blind.next.has_value());
  EXPECT_EQ(blind.bound, 0);
}

// The bulb of a point light stands in that room, too: every field of every cell has something to say.
SceneBuilder room_with_a_bulb() {
  SceneBuilder builder = room(DielectricDescription{});
  builder.shape(SphereDescription{{0.4f, -0.3f, -0.3f}, 0.1f}, builder.add(DielectricDescription{}));
  builder.emitter(PointEmitterDescription{{0.4f, -0.3f, -0.3f}, Rgb{0.2f}});
  return builder;
}

TEST(LightAudit, IsTheSameForAnyNumberOfThreads) {
  const Scene scene(wide_view(room_with_a_bulb(), 50), 1);
  const LightAudit one = audit_light(scene, kFrame, 3, 1, kNever), three = audit_light(scene, kFrame, 3, 3, kNever);
  ASSERT_EQ(one.cells.size(), three.cells.size());
  double blind = 0;
  for (std::size_t i = 0; i < one.cells.size(); ++i) {
    EXPECT_EQ(one.cells[i].radiance, three.cells[i].radiance);
    EXPECT_EQ(one.cells[i].variance, three.cells[i].variance);
    EXPECT_EQ(one.cells[i].unreachable, three.cells[i].unreachable);
    EXPECT_EQ(one.cells[i].blind, three.cells[i].blind);
    EXPECT_GT(one.cells[i].unreachable, 0);
    blind += one.cells[i].blind;
  }
  EXPECT_EQ(one.unreachable_share, three.unreachable_share);
  EXPECT_GT(one.unreachable_share, 0);
  EXPECT_GT(blind, 0);
  // Twin: another seed is another audit.
  const LightAudit other = audit_light(scene, kFrame, 4, 1, kNever);
  EXPECT_NE(one.cells[0].radiance, other.cells[0].radiance);
  EXPECT_NE(one.cells[0].unreachable, other.cells[0].unreachable);
}

// While both take the least number of particles, which depends on the crop above it: then the cells differ by their noise.
TEST(LightAudit, OfASmallCropKeepsItsCells) {
  const Scene scene(wide_view(room(DiffuseDescription{Rgb{0.5f}}), 50), 1);
  const LightAudit whole = audit_light(scene, kFrame, 3, 1, kNever), part = audit_light(scene, {32, 32, 32, 32}, 3, 1, kNever);
  ASSERT_EQ(part.cells.size(), 1u);
  EXPECT_EQ(part.cells[0].radiance, whole.cells[3].radiance);
}

TEST(LightAudit, EndsWhenItIsCancelled) {
  const std::atomic<bool> cancelled{true};
  const Scene scene(wide_view(room_with_a_bulb(), 50), 1);
  EXPECT_THROW(audit_light(scene, kFrame, 3, 2, cancelled), CancelledError);
  AuditMemory memory;
  EXPECT_THROW(memory.find(scene, kFrame, 3, 2, cancelled), CancelledError);
  // Nothing of it is kept: the next one is whole.
  const LightAudit next = memory.find(scene, kFrame, 3, 2, kNever);
  EXPECT_EQ(next.cells[0].radiance, audit_light(scene, kFrame, 3, 2, kNever).cells[0].radiance);
  EXPECT_NO_THROW(memory.find(scene, kFrame, 3, 2, cancelled)) << "that one is kept, and costs nothing";
}

// Flux beyond all numbers is not followed, and leaves no share that is no number.
TEST(LightAudit, SurvivesEmittersBeyondAllNumbers) {
  for (const float intensity : {1e37f, 2e38f}) {
    SceneBuilder builder = room_with_a_bulb();
    builder.emitter(PointEmitterDescription{{0, 0.5f, 0}, Rgb{intensity}});
    const LightAudit audit = audit_light(Scene(wide_view(builder, 50), 1), kFrame, 3, 1, kNever);
    EXPECT_TRUE(std::isfinite(audit.unreachable_share)) << intensity;
    for (const LightAudit::Cell& cell : audit.cells) EXPECT_TRUE(std::isfinite(cell.radiance + cell.unreachable)) << intensity;
  }
}

TEST(LightAudit, IsLeftOutWhereItHasNothingToSay) {
  SceneBuilder sky;
  sky.floor(0, 1, sky.diffuse(0.5f)).emitter(ConstantEmitterDescription{}).look({0, 1, 0}, {0, 0, 0});
  EXPECT_EQ(audit_need(Scene(sky.description(), 1)).kind, AuditNeed::kNotNeeded);
  EXPECT_EQ(audit_light(Scene(sky.description(), 1), {0, 0, 4, 4}, 0, 1, kNever).outcome, LightAudit::kAudited);

  SceneBuilder fog = room(DiffuseDescription{});
  fog.interior(fog.medium({}));
  EXPECT_EQ(audit_need(Scene(fog.description(), 1)).kind, AuditNeed::kNotPossible);
  EXPECT_EQ(audit_light(Scene(fog.description(), 1), {0, 0, 4, 4}, 0, 1, kNever).outcome, LightAudit::kNotPossible);
}

// A bulb and, somewhere, a boundary that light passes: the picture is black, and nobody can say so.
TEST(LightAudit, KeepsABulbFromBeingClaimedWhereItIsNotPossible) {
  const auto render = [](bool glass) {
    SceneBuilder builder;
    builder.floor(0, 3, builder.diffuse(0.5f)).emitter(PointEmitterDescription{{0, 1, 0}, Rgb{1}});
    if (glass) builder.shape(SphereDescription{{0, 1, 0}, 0.2f}, builder.add(DielectricDescription{}));
    builder.shape(SphereDescription{{0, 2, 5}, 0.2f}, builder.add(NullDescription{}));
    builder.look({2, 2, 0}, {1.2, 0, 0});
    const Scene scene(wide_view(builder, 35), 1);
    const auto integrator = make_integrator("path", scene);
    return render_frame(scene, *integrator, {kFrame, 64, 2, 1, {{}, {}, 0.1}}, kNever);
  };
  const FrameResult bulb = render(true);
  ASSERT_EQ(bulb.warnings.size(), 1u);
  EXPECT_EQ(bulb.warnings[0].find("goal not reached"), 0u) << bulb.warnings[0];
  EXPECT_GT(bulb.timeline.back().error_bound.value(), 0.1);
  EXPECT_FALSE(bulb.error_unseen.has_value());
  // Twin: without glass around it the light is found, and claimed with a word on what the claim rests on.
  const FrameResult open = render(false);
  ASSERT_EQ(open.warnings.size(), 1u);
  EXPECT_NE(open.warnings[0].find("noise alone"), std::string::npos) << open.warnings[0];
  EXPECT_LE(open.timeline.back().error_bound.value(), 0.1);
}

}  // namespace
}  // namespace fluxfarm
