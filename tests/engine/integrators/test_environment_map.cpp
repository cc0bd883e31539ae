// Path tracing under an environment map, against quadrature and against the constant environment.
//
// Each comparison is a two-sided z-test at an overall level of 1 % over all of them (Sidak), with a standard error of at most
// 0.3 % of the answer, and has a twin that must fail.
#include <gtest/gtest.h>

#include "emitters/envmap_emitter.h"
#include "support/scene_builder.h"
#include "support/sky.h"

namespace fluxfarm::testing {
namespace {

// Two-sided normal quantile at 1 - (1 - 0.01)^(1/10) = 1.0e-3: there are fewer than 10 comparisons below.
constexpr double kZ = 3.29;
constexpr float kRho = 0.8f;

void expect_answer(const Measurement& m, double expected) {
  EXPECT_LE(m.standard_error, 0.003 * expected) << "too noisy to see an error of 1 %";
  EXPECT_LE(m.z(expected), kZ) << "measured " << m.mean << " +- " << m.standard_error << ", expected " << expected;
  EXPECT_GT(m.z(expected * 1.02), kZ) << "the test has no teeth";
}

SceneBuilder plane(int material_of(SceneBuilder&)) {
  SceneBuilder scene;
  scene.floor(0, 20, material_of(scene));
  scene.look({0.5, 2, 0.5}, {0, 0, 0});
  return scene;
}

int diffuse(SceneBuilder& scene) { return scene.diffuse(kRho); }

int rough_metal(SceneBuilder& scene) {
  RoughConductorDescription metal;
  metal.roughness.alpha_u = metal.roughness.alpha_v = 0.3f;
  return scene.add(metal);
}

double falling(const EnvmapEmitterDescription& map, bool sine = true) {
  const EnvmapEmitter emitter(map.image, map.to_world, 1);
  return irradiance([&](Vec3f w) { return emitter.from(w).radiance.g; }, {0, 1, 0}, sine);
}

TEST(EnvironmentMap, LightsADiffusePlaneAsQuadratureSays) {
  for (const Transform& to_world : {Transform(), Transform::rotate(1, 0.2, 0.4, 130)}) {
    const EnvmapEmitterDescription map{patchy_sky(16, 11), to_world};
    const Measurement m = measure(plane(diffuse).emitter(map).description(), 1024);
    const double per_irradiance = static_cast<double>(kRho) / M_PI;
    expect_answer(m, per_irradiance * falling(map));
    EXPECT_GT(m.z(per_irradiance * falling(map, false)), kZ) << "a renderer that drops the sine is told apart";
  }
}

TEST(EnvironmentMap, FindsASmallSun) {
  // By BSDF sampling alone the standard error would be far above the bound.
  const EnvmapEmitterDescription map{sunny_sky(), Transform()};
  expect_answer(measure(plane(diffuse).emitter(map).description(), 1024), static_cast<double>(kRho) / M_PI * falling(map));
}

TEST(EnvironmentMap, SharesTheChoiceWithOtherLights) {
  const EnvmapEmitterDescription map{patchy_sky(16, 11), Transform()};
  SceneBuilder scene = plane(diffuse).emitter(map);
  scene.emitter(PointEmitterDescription{{0, 1, 0}, Rgb{1.0f}}).emitter(ConstantEmitterDescription{Rgb{0.25f}});
  expect_answer(measure(scene.description(), 4096), static_cast<double>(kRho) / M_PI * (1 + M_PI / 4 + falling(map)));
}

// The weights of the two techniques add up: an even map is a constant environment, whatever the material.
TEST(EnvironmentMap, EvenOneIsAConstantEnvironment) {
  for (const auto material : {diffuse, rough_metal}) {
    const Measurement constant = measure(plane(material).emitter(ConstantEmitterDescription{Rgb{3.0f}}).description(), 4096);
    const Measurement map =
        measure(plane(material).emitter(EnvmapEmitterDescription{even_sky(3), Transform()}).description(), 4096, 2);
    const double error = std::hypot(constant.standard_error, map.standard_error);
    EXPECT_LE(error, 0.003 * constant.mean);
    EXPECT_LE(std::abs(constant.mean - map.mean), kZ * error) << constant.mean << " " << map.mean;
    EXPECT_GT(std::abs(1.02 * constant.mean - map.mean), kZ * error) << "the test has no teeth";
  }
}

TEST(EnvironmentMap, IsSeenInAMirrorAndThroughNothing) {
  const LatLongImage sky = patchy_sky(16, 11);
  const EnvmapEmitterDescription map{sky, Transform()};
  SceneBuilder mirror = plane([](SceneBuilder& scene) { return scene.add(ConductorDescription{.perfect = true}); });
  const Vec3f up = normalize(Vec3f{-0.5f, 2, -0.5f});
  EXPECT_NEAR(measure(mirror.emitter(map).description(), 8).mean, sky.radiance(sky.cell(up)).g, 1e-3f);
  SceneBuilder empty = plane(diffuse).emitter(map);
  empty.look({0, 1, 0}, {3, 2, -1});
  EXPECT_NEAR(measure(empty.description(), 8).mean, sky.radiance(sky.cell(normalize(Vec3f{3, 1, -1}))).g, 1e-3f);
}

TEST(EnvironmentMap, IsHiddenFromTheCameraOnlyWhenEmittersAre) {
  const EnvmapEmitterDescription map{even_sky(1), Transform()};
  SceneDescription empty = plane(diffuse).emitter(map).look({0, 1, 0}, {3, 2, -1}).description();
  empty.method.hide_emitters = true;
  EXPECT_EQ(measure(empty, 8).mean, 0);
  SceneDescription lit = plane(diffuse).emitter(map).description();
  lit.method.hide_emitters = true;
  EXPECT_NEAR(measure(lit, 1024).mean, static_cast<double>(kRho), 0.01);
}

}  // namespace
}  // namespace fluxfarm::testing
