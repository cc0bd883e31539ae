// What the audit tells of the variance that light leaves in path tracing which mirrors and gloss have scattered.
#include <gtest/gtest.h>

#include <string>

#include "integrators/audit/light_audit.h"
#include "integrators/audit_scenes.h"

namespace fluxfarm {
namespace {

using testing::kFrame;
using testing::kNever;
using testing::kSide;
using testing::SceneBuilder;
using testing::wide_view;

// A floor under a ceiling.
SceneBuilder floor_under(MaterialDescription ceiling) {
  SceneBuilder builder;
  builder.floor(0, 3, builder.diffuse(0.5f));
  builder.lamp_down(0, 2, 0, 6, 6, builder.add(std::move(ceiling)), 0);
  builder.look({2.2, 1.2, 0}, {1.2, 0, 0});
  return builder;
}

// A lamp lights the floor by way of the ceiling alone: it faces up.
SceneBuilder floor_under(MaterialDescription ceiling, float lamp_side) {
  SceneBuilder builder = floor_under(std::move(ceiling));
  builder.shape(RectangleDescription{Transform::translate(0, 1, 0) * Transform::rotate(1, 0, 0, -90) *
                                     Transform::scale(lamp_side / 2.0, lamp_side / 2.0, 1)},
                builder.diffuse(0), 10);
  return builder;
}

MaterialDescription mirror() { return ConductorDescription{.perfect = true}; }
MaterialDescription metal(float alpha) {
  return RoughConductorDescription{{.perfect = true}, {.alpha_u = alpha, .alpha_v = alpha}};
}

// Means over the picture: of the variance of one sample of a pixel, and of the audit's mean square less the square of its mean.
struct Variances {
  double of_paths = 0, of_audit = 0;
};

Variances variances(const SceneBuilder& builder, std::uint64_t pictures) {
  // The floor, the ceiling and the lamp: the floor's own light is left out.
  SceneDescription description = wide_view(SceneBuilder(builder).max_depth(4), 30);
  const Scene scene(description, 1);
  const auto integrator = make_integrator("path", scene);
  Variances found;
  for (std::uint64_t seed = 0; seed < pictures; ++seed) {
    // So few that their strata are larger than the lamp looks.
    constexpr std::uint32_t kSamples = 32;
    const FrameResult result = render_frame(scene, *integrator, {kFrame, 64, 2, seed, {kSamples, {}, {}}}, kNever);
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const PixelEstimate pixel = result.film.estimate(x, y);
        const auto error = static_cast<double>(pixel.standard_error[0]);
        found.of_paths += error * error * kSamples / (static_cast<double>(pictures) * kFrame.pixels());
      }
    }
  }
  constexpr int kAudits = 8;
  for (int seed = 0; seed < kAudits; ++seed) {
    const LightAudit audit = audit_light(scene, kFrame, static_cast<std::uint64_t>(seed), 2, kNever);
    for (const LightAudit::Cell& cell : audit.cells) {
      found.of_audit += (cell.sharp_square - cell.radiance * cell.radiance) / kAudits / static_cast<double>(audit.cells.size());
    }
  }
  return found;
}

TEST(SharpSquare, IsTheVarianceOfPathsThatHitALampInAMirrorByChance) {
  const Variances found = variances(floor_under(mirror(), 0.2f), 32);
  RecordProperty("audit over paths", std::to_string(found.of_audit / found.of_paths));
  EXPECT_GT(found.of_paths, 0);
  EXPECT_NEAR(found.of_audit / found.of_paths, 1, 0.1);
}

// The lobe is wider than the lamp looks: what a path finds in it is dimmer than the lamp.
TEST(SharpSquare, IsLessBehindGlossByWhatItSpreadsTheLamp) {
  const Variances gloss = variances(floor_under(metal(0.05f), 0.05f), 32);
  RecordProperty("audit over paths", std::to_string(gloss.of_audit / gloss.of_paths));
  EXPECT_GT(gloss.of_audit / gloss.of_paths, 0.5);
  EXPECT_LT(gloss.of_audit / gloss.of_paths, 2);
  // Twin: a mirror's is many times as much.
  EXPECT_GT(variances(floor_under(mirror(), 0.05f), 1).of_audit, 5 * gloss.of_audit);
}

// A point lamp has no image that a path could hit, but where gloss shows it paths find it by asking.
TEST(SharpSquare, CountsPointLampsThatGlossShows) {
  SceneBuilder builder = floor_under(metal(0.05f));
  builder.emitter(SpotEmitterDescription{{0, 1, 0}, {0, 1, 0}, Rgb{1}, 60, 60});
  const Variances gloss = variances(builder, 32);
  RecordProperty("audit over paths", std::to_string(gloss.of_audit / gloss.of_paths));
  EXPECT_GT(gloss.of_audit / gloss.of_paths, 0.5);
  EXPECT_LT(gloss.of_audit / gloss.of_paths, 2);
}

TEST(SharpSquare, IsNothingWherePathsFindTheLightThemselves) {
  for (const MaterialDescription& ceiling : {MaterialDescription(DiffuseDescription{}), metal(1)}) {
    const LightAudit audit = audit_light(Scene(wide_view(floor_under(ceiling, 0.2f), 30), 1), kFrame, 1, 2, kNever);
    for (const LightAudit::Cell& cell : audit.cells) {
      EXPECT_GT(cell.radiance, 0);
      EXPECT_LT(cell.sharp_square, cell.radiance * cell.radiance);
    }
  }
}

}  // namespace
}  // namespace fluxfarm
