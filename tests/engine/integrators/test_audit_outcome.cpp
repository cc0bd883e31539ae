// What an audit decides: which goals may be claimed, and that nothing but the scene, the crop and the seed has a say in it.
#include <gtest/gtest.h>

#include <cmath>

#include "film/error_goal.h"
#include "integrators/audit/light_audit.h"
#include "integrators/audit_scenes.h"
#include "support/error.h"
#include "support/failure_row.h"
#include "worker/loaded_scene.h"

namespace fluxfarm {
namespace {

using testing::kFrame;
using testing::kNever;
using testing::room;
using testing::SceneBuilder;
using testing::wide_view;

// C8: a picture of a floor under a bulb. Nothing of it disagrees with itself, for paths find nothing at all.
TEST(AuditOutcome, KeepsABulbFromBeingClaimed) {
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
  testing::tell_failure("a point light in glass", "off", "without the audit 10 % of a black picture is claimed");
}

// A pool: what a small lamp throws through the water is seen through it, where the audit is blind, and hardly a path finds it.
TEST(AuditOutcome, KeepsLightThroughWaterSeenThroughWaterFromBeingClaimed) {
  SceneBuilder builder;
  builder.floor(0, 3, builder.diffuse(0.5f));
  builder.shape(testing::cube(Transform::translate(0, 0.55, 0) * Transform::scale(3, 0.05, 3)),
                builder.add(DielectricDescription{}));
  builder.lamp_down(0, 3, 0, 1e-3f, 1e-3f, builder.diffuse(0), 4e7f);
  builder.look({0, 2.5, 1}, {0, 0, 0});
  const Scene scene(wide_view(builder, 40), 1);
  const auto run = [&](const char* method) {
    const auto integrator = make_integrator(method, scene);
    return render_frame(scene, *integrator, {kFrame, 64, 2, 1, {{}, {}, 0.1}}, kNever);
  };
  const FrameResult by_paths = run("path");
  ASSERT_EQ(by_paths.warnings.size(), 1u);
  EXPECT_NE(by_paths.warnings[0].find("seen in mirrors or through glass: ask for integrator photon-progressive"), std::string::npos)
      << by_paths.warnings[0];
  EXPECT_GT(by_paths.error_unseen.value(), 0.1);
  EXPECT_LT(by_paths.summary.mean_samples, 100) << "no sample can save it";
  // Photons find it, and claim.
  const FrameResult by_photons = run("photon-progressive");
  EXPECT_TRUE(by_photons.warnings.empty());
  EXPECT_GT(by_photons.summary.mean[1], 2 * by_paths.summary.mean[1]);
  // Twin: an audit that says nothing of it lets the picture of the paths be claimed.
  LightAudit audit = audit_light(scene, kFrame, 1, 1, kNever);
  EXPECT_GT(audit.rare_share, 0.5);
  audit.rare_share = 0;
  EXPECT_LT(look_at(by_paths.film, {0.1}, 1, &audit).bound, 0.1);
  testing::tell_failure("caustic through water, seen through it", "off", "10 % of a picture without it is claimed");
  testing::tell_failure("caustic through water, seen through it", "on", "\"" + by_paths.warnings[0] + "\"");
}

// The bulb of a point light stands in that room, too: every field of every cell has something to say.
SceneBuilder room_with_a_bulb() {
  SceneBuilder builder = room(DielectricDescription{});
  builder.shape(SphereDescription{{0.4f, -0.3f, -0.3f}, 0.1f}, builder.add(DielectricDescription{}));
  builder.emitter(PointEmitterDescription{{0.4f, -0.3f, -0.3f}, Rgb{0.2f}});
  return builder;
}

TEST(AuditOutcome, IsTheSameForAnyNumberOfThreads) {
  const Scene scene(wide_view(room_with_a_bulb(), 50), 1);
  const LightAudit one = audit_light(scene, kFrame, 3, 1, kNever), three = audit_light(scene, kFrame, 3, 3, kNever);
  ASSERT_EQ(one.cells.size(), three.cells.size());
  double blind = 0;
  for (std::size_t i = 0; i < one.cells.size(); ++i) {
    EXPECT_EQ(one.cells[i].radiance, three.cells[i].radiance);
    EXPECT_EQ(one.cells[i].variance, three.cells[i].variance);
    EXPECT_EQ(one.cells[i].unreachable, three.cells[i].unreachable);
    EXPECT_EQ(one.cells[i].blind, three.cells[i].blind);
    EXPECT_EQ(one.cells[i].sharp_square, three.cells[i].sharp_square);
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
TEST(AuditOutcome, OfASmallCropKeepsItsCells) {
  const Scene scene(wide_view(room(DiffuseDescription{Rgb{0.5f}}), 50), 1);
  const LightAudit whole = audit_light(scene, kFrame, 3, 1, kNever), part = audit_light(scene, {32, 32, 32, 32}, 3, 1, kNever);
  ASSERT_EQ(part.cells.size(), 1u);
  EXPECT_EQ(part.cells[0].radiance, whole.cells[3].radiance);
}

TEST(AuditOutcome, EndsWhenItIsCancelled) {
  const std::atomic<bool> cancelled{true};
  const Scene scene(wide_view(room_with_a_bulb(), 50), 1);
  EXPECT_THROW(audit_light(scene, kFrame, 3, 2, cancelled), CancelledError);
  const auto integrator = make_integrator("path", scene);
  AuditMemory memory;
  EXPECT_THROW(memory.find(scene, *integrator, kFrame, 3, 2, cancelled), CancelledError);
  // Nothing of it is kept: the next one is whole.
  const LightAudit next = memory.find(scene, *integrator, kFrame, 3, 2, kNever);
  EXPECT_EQ(next.cells[0].radiance, audit_light(scene, kFrame, 3, 2, kNever).cells[0].radiance);
  EXPECT_NO_THROW(memory.find(scene, *integrator, kFrame, 3, 2, cancelled)) << "that one is kept, and costs nothing";
}

// Flux beyond all numbers is not followed, and leaves no share that is no number.
TEST(AuditOutcome, SurvivesEmittersBeyondAllNumbers) {
  for (const float intensity : {1e37f, 2e38f}) {
    SceneBuilder builder = room_with_a_bulb();
    builder.emitter(PointEmitterDescription{{0, 0.5f, 0}, Rgb{intensity}});
    const LightAudit audit = audit_light(Scene(wide_view(builder, 50), 1), kFrame, 3, 1, kNever);
    EXPECT_TRUE(std::isfinite(audit.unreachable_share)) << intensity;
    for (const LightAudit::Cell& cell : audit.cells)
      EXPECT_TRUE(std::isfinite(cell.radiance + cell.unreachable + cell.sharp_square)) << intensity;
  }
}

TEST(AuditOutcome, IsLeftOutWhereItHasNothingToSay) {
  SceneBuilder sky;
  sky.floor(0, 1, sky.diffuse(0.5f)).emitter(ConstantEmitterDescription{}).look({0, 1, 0}, {0, 0, 0});
  EXPECT_EQ(audit_need(Scene(sky.description(), 1)).kind, AuditNeed::kNotNeeded);
  EXPECT_EQ(audit_light(Scene(sky.description(), 1), {0, 0, 4, 4}, 0, 1, kNever).outcome, LightAudit::kAudited);

  SceneBuilder fog = room(DiffuseDescription{});
  fog.interior(fog.medium({}));
  EXPECT_EQ(audit_need(Scene(fog.description(), 1)).kind, AuditNeed::kNotPossible);
  EXPECT_EQ(audit_light(Scene(fog.description(), 1), {0, 0, 4, 4}, 0, 1, kNever).outcome, LightAudit::kNotPossible);

  // With a point and glass paths may miss anything; photons do not.
  fog.emitter(PointEmitterDescription{{0, 0.5f, 0}, Rgb{1}});
  fog.shape(SphereDescription{{0, 0, 0}, 0.1f}, fog.add(DielectricDescription{}));
  const Scene caustics(fog.description(), 1);
  EXPECT_EQ(audit_light(caustics, {0, 0, 4, 4}, 0, 1, kNever).outcome, LightAudit::kNotPossibleWithUnreachable);
  EXPECT_EQ(audit_light(caustics, {0, 0, 4, 4}, 0, 1, kNever, true).outcome, LightAudit::kNotPossible);
}

// A bulb and, somewhere, a boundary that light passes: the picture is black, and nobody can say so.
TEST(AuditOutcome, KeepsABulbFromBeingClaimedWhereItIsNotPossible) {
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
