// Participating media with known answers: M1 M3 M4 M5 of the accuracy catalogue, and nested dielectrics.
//
// Two-sided z-tests at an overall level of 1 % (Sidak over fewer than 40 comparisons), each with a standard error of at most 0.7 %
// of the answer and a must-fail twin: what a wrong renderer would give.
#include <gtest/gtest.h>

#include "integrators/path/path_integrator.h"
#include "integrators/path/volume_path_integrator.h"
#include "support/scene_builder.h"
#include "support/sky.h"

namespace fluxfarm::testing {
namespace {

constexpr double kPiD = 3.14159265358979323846;
// Two-sided normal quantile at 1 - (1 - 0.01)^(1/40) = 2.5e-4.
constexpr double kZ = 3.66;

void expect_answer(const Measurement& m, double expected) {
  EXPECT_LE(m.standard_error, 0.007 * expected) << "too noisy to see an error of 2 %";
  EXPECT_LE(m.z(expected), kZ) << "measured " << m.mean << " +- " << m.standard_error << ", expected " << expected;
}

void expect_rejected(const Measurement& m, double wrong) {
  EXPECT_GT(m.z(wrong), kZ) << "the test has no teeth: measured " << m.mean << " +- " << m.standard_error << " passes for "
                            << wrong;
}

HomogeneousMediumDescription grey(float sigma_t, float albedo, float g = 0) { return {Rgb{sigma_t}, Rgb{albedo}, g}; }

// The measured channel is the middle one of three that differ much.
HomogeneousMediumDescription coloured(float sigma_t, float albedo, float g = 0) {
  return {{0.4f * sigma_t, sigma_t, 2.5f * sigma_t}, {1.0f, albedo, 0.5f * albedo}, g};
}

// A ball of a medium behind a null boundary.
SceneBuilder ball(const HomogeneousMediumDescription& medium, float radius) {
  SceneBuilder scene;
  scene.shape(SphereDescription{{0, 0, 0}, radius}, scene.add(NullDescription{}));
  scene.interior(scene.medium(medium));
  scene.look({0, 0, 5}, {0, 0, 0});
  return scene;
}

// M1: T = exp(-sigma_a d), before an even sky.
TEST(CatalogueM1, AbsorbingSlab) {
  for (const HomogeneousMediumDescription& medium : {grey(0.35f, 0), coloured(0.35f, 0)}) {
    SceneBuilder scene;
    scene.shape(cube(Transform::scale(3, 3, 1)), scene.add(NullDescription{}));
    scene.interior(scene.medium(medium));
    scene.emitter(ConstantEmitterDescription{Rgb{2.0f}});
    scene.look({0, 0, 5}, {0, 0, 0});
    const Measurement m = measure(scene.description(), 16384);
    expect_answer(m, 2 * std::exp(-0.7));
    expect_rejected(m, 2 * std::exp(-0.7 * 1.05));
    expect_rejected(m, 2);
  }
}

// M1 on both ways: the camera and the lamp over a floor stand in the same absorbing fog. Shapes without media leave it as it is.
TEST(CatalogueM1, LampOverAFloorInFog) {
  SceneBuilder scene;
  scene.floor(0, 20, scene.diffuse(0.8f));
  scene.emitter(PointEmitterDescription{{0, 1, 0}, Rgb{1.0f}});
  scene.camera_in(scene.medium(grey(0.3f, 0)));
  scene.look({0, 2, 0}, {0, 0, 0});
  const Measurement m = measure(scene.description(), 16384);
  const double reflected = static_cast<double>(0.8f) / kPiD;
  expect_answer(m, reflected * std::exp(-0.3 * (1 + 2 - 1e-3)));  // media begin at the near plane
  expect_rejected(m, reflected * std::exp(-0.3 * 2));             // no extinction of the shadow ray
  expect_rejected(m, reflected * std::exp(-0.3));                 // none of the camera ray
}

// M1 through two boundaries on the way to the lamp: the fog is a slab between lamp and floor, no scattering, nothing is random.
TEST(CatalogueM1, ShadowRaysPassNullBoundaries) {
  SceneBuilder scene;
  scene.floor(0, 20, scene.diffuse(0.8f));
  scene.emitter(PointEmitterDescription{{0, 1, 0}, Rgb{1.0f}});
  scene.shape(cube(Transform::translate(0, 0.5, 0) * Transform::scale(0.2, 0.25, 0.2)), scene.add(NullDescription{}));
  scene.interior(scene.medium(grey(0.8f, 0)));
  scene.look({2, 1, 0}, {0, 0, 0});
  const double mean = measure(scene.description(), 8).mean;
  EXPECT_NEAR(mean, static_cast<double>(0.8f) / kPiD * std::exp(-0.8 * 0.5), 1e-5);
  EXPECT_GT(std::abs(mean - static_cast<double>(0.8f) / kPiD), 0.05) << "a lamp that shines undimmed is told apart";
}

// Null boundaries alone change nothing: D1 with a bubble around the lamp.
TEST(CatalogueD1, LampInANullBubble) {
  SceneBuilder scene;
  scene.floor(0, 20, scene.diffuse(0.8f));
  scene.emitter(PointEmitterDescription{{0, 1, 0}, Rgb{1.0f}});
  scene.shape(SphereDescription{{0, 1, 0}, 0.3f}, scene.add(NullDescription{}));
  scene.look({1.5, 2, 0.5}, {1, 0, 0});
  EXPECT_NEAR(measure(scene.description(), 8).mean, static_cast<double>(0.8f) / kPiD * 0.353553391, 5e-5);
}

// M3: a medium that absorbs nothing is invisible in an even sky.
TEST(CatalogueM3, InvisibleMedium) {
  for (const bool map : {false, true}) {
    for (const HomogeneousMediumDescription& medium :
         {grey(3, 1, 0.7f), coloured(3, 1, -0.3f), HomogeneousMediumDescription{{1, 4, 9}, Rgb{1.0f}, 0.5f}}) {
      SceneBuilder scene = ball(medium, 1);
      if (map) {
        scene.emitter(EnvmapEmitterDescription{even_sky(2), {}});
      } else {
        scene.emitter(ConstantEmitterDescription{Rgb{2.0f}});
      }
      expect_answer(measure(scene.description(), 4096), 2);
    }
  }
}

TEST(CatalogueM3, TwinWithAlbedoBelowOneIsRejected) {
  SceneBuilder scene = ball(coloured(3, 0.98f, 0.7f), 1);
  scene.emitter(ConstantEmitterDescription{Rgb{2.0f}});
  expect_rejected(measure(scene.description(), 4096), 2);
}

// M3 behind glass: what is not reflected comes out again somewhere.
TEST(CatalogueM3, InvisibleMediumInGlass) {
  SceneBuilder scene;
  const int milk = scene.medium(coloured(4, 1, 0.6f));
  scene.shape(SphereDescription{{0, 0, 0}, 1}, scene.add(DielectricDescription{.eta = 1.5f}));
  scene.shape(SphereDescription{{0, 0, 0}, 0.8f}, scene.add(DielectricDescription{.eta = 1.33f / 1.5f}));
  scene.interior(milk);
  scene.emitter(ConstantEmitterDescription{Rgb{2.0f}});
  scene.look({0.4, 0, 5}, {0.4, 0, 0});
  expect_answer(measure(scene.description(), 8192), 2);
}

// M4: single scattering of a point light at distance h from the ray with its foot at t0, between the camera and a black wall at D:
// L = sigma_s integral of p I exp(-sigma_t (t + d)) / d^2 dt.
struct Airlight {
  double sigma_s, sigma_t, g;
};
constexpr double kWall = 4, kFoot = 1.2, kHeight = 1;

double airlight(const Airlight& a, bool dims_light = true) {
  constexpr int kSteps = 20000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double t = (i + 0.5) * kWall / kSteps;
    const double d = std::hypot(kHeight, kFoot - t), cosine = (kFoot - t) / d;
    const double phase = (1 - a.g * a.g) / (4 * kPiD * std::pow(1 + a.g * a.g - 2 * a.g * cosine, 1.5));
    sum += a.sigma_s * phase * std::exp(-a.sigma_t * (t + (dims_light ? d : 0))) / (d * d) * kWall / kSteps;
  }
  return sum;
}

Measurement measure_airlight(const HomogeneousMediumDescription& medium, double foot) {
  SceneBuilder scene;
  scene.shape(RectangleDescription{Transform::translate(0, 0, -kWall) * Transform::scale(5, 5, 1)}, scene.diffuse(0));
  scene.emitter(PointEmitterDescription{{0, static_cast<float>(kHeight), static_cast<float>(-foot)}, Rgb{1.0f}});
  scene.camera_in(scene.medium(medium));
  scene.look({0, 0, 0}, {0, 0, -1}).near_clip(1e-6f).max_depth(2);
  return measure(scene.description(), 8192);
}

TEST(CatalogueM4, AirlightOfAPointLight) {
  // The catalogue's number, whose foot is in the middle.
  const Measurement m = measure_airlight(grey(0.5f, 0.8f), 2);
  expect_answer(m, 0.01485799);
  expect_rejected(m, 0.01485799 * 1.03);
}

TEST(CatalogueM4, AirlightWithAPeakedPhaseFunction) {
  for (const double g : {0.6, -0.6}) {
    const Airlight a{0.2, 0.4, g};
    for (const HomogeneousMediumDescription& medium :
         {grey(0.4f, 0.5f, static_cast<float>(g)), coloured(0.4f, 0.5f, static_cast<float>(g))}) {
      const Measurement m = measure_airlight(medium, kFoot);
      expect_answer(m, airlight(a));
      expect_rejected(m, airlight({0.2, 0.4, -g}));  // forwards and backwards swapped
      expect_rejected(m, airlight({0.2, 0.4, 0}));
      expect_rejected(m, airlight(a, false));
    }
  }
}

// M5: plane albedo of a half-space that scatters evenly, as the radiance under an even sky: they are the same by reciprocity.
struct HalfSpace {
  float albedo;
  double cosine, answer;
  bool map;  // next-event estimation takes part
  bool colour = true;
};

void expect_plane_albedo(const HalfSpace& c, std::uint32_t spp) {
  SceneBuilder scene;
  scene.floor(0, 1000, scene.add(NullDescription{}));
  scene.interior(scene.medium(c.colour ? coloured(2, c.albedo) : grey(2, c.albedo)));
  if (c.map) {
    scene.emitter(EnvmapEmitterDescription{even_sky(1), {}});
  } else {
    scene.emitter(ConstantEmitterDescription{Rgb{1.0f}});
  }
  scene.look({std::sqrt(1 - c.cosine * c.cosine), c.cosine, 0}, {0, 0, 0});
  const Measurement m = measure(scene.description(), spp);
  expect_answer(m, c.answer);
  expect_rejected(m, c.answer * 1.04);
}

TEST(CatalogueM5, PlaneAlbedoOfADarkHalfSpace) {
  expect_plane_albedo({0.5f, 1, 0.115226, true}, 4096);
  expect_plane_albedo({0.5f, 0.5, 0.160144, false}, 8192);
}

TEST(CatalogueM5, PlaneAlbedoOfABrightHalfSpace) {
  expect_plane_albedo({0.9f, 1, 0.414947, false}, 4096);
  expect_plane_albedo({0.9f, 0.5, 0.507939, true}, 1024);
  expect_plane_albedo({0.99f, 1, 0.752721, false, false}, 2048);
}

// An area light in fog is found by next-event estimation and by the phase function, weighted against each other. This one is so
// small that it is a point of the intensity radiance times projected area; what is left of its size is below 0.5 %.
TEST(VolumePath, SmallAreaLightActsAsAPointLight) {
  constexpr float kRadius = 0.01f;
  SceneBuilder scene;
  scene.shape(RectangleDescription{Transform::translate(0, 0, -kWall) * Transform::scale(5, 5, 1)}, scene.diffuse(0));
  scene.shape(SphereDescription{{0, 1, -1.2f}, kRadius}, scene.diffuse(0), 1 / (kRadius * kRadius * static_cast<float>(kPiD)));
  scene.camera_in(scene.medium(grey(0.4f, 0.5f, 0.6f)));
  scene.look({0, 0, 0}, {0, 0, -1}).near_clip(1e-6f).max_depth(2);
  const double mean = measure(scene.description(), 8192).mean;
  EXPECT_NEAR(mean / airlight({0.2, 0.4, 0.6}), 1, 5e-3);
  EXPECT_GT(std::abs(mean / airlight({0.2, 0.4, 0.6}, false) - 1), 0.1) << "shadow rays without extinction are told apart";
}

// A large one, through a null boundary between scattering and light: by next-event estimation and by directions alone it must be
// the same. Bounces without a technique of their own for the light, as at a rough glass, have weight one.
TEST(VolumePath, LargeAreaLightBehindANullBoundaryIsCountedOnce) {
  const auto measured = [](bool area) {
    SceneBuilder scene = ball(grey(1.5f, 0.9f, 0.3f), 1);
    if (area) {
      scene.shape(SphereDescription{{0, 0, 0}, 8}, scene.diffuse(0), 2, true);  // emits inwards
    } else {
      scene.emitter(ConstantEmitterDescription{Rgb{2.0f}});
    }
    return measure(scene.description(), 4096);
  };
  const Measurement lamp = measured(true), sky = measured(false);
  expect_answer(lamp, sky.mean);
  expect_rejected(lamp, 2);
}

// Nested dielectrics along the axis of concentric spheres: a glass wall (1 | 1.5 | 1.33) around an absorbing core. Each wall
// reflects and passes as two interfaces without interference, the sky shines from both sides.
TEST(NestedDielectrics, AbsorbingCoreInAGlassWall) {
  const double r1 = std::pow(0.5 / 2.5, 2), r2 = std::pow(0.17 / 2.83, 2), tau = std::exp(-0.6 * 2 * 0.8);
  const double between = 1 - r1 * r2;
  const double passes = (1 - r1) * (1 - r2) / between;
  const double reflects = r1 + (1 - r1) * (1 - r1) * r2 / between;
  const double reflects_inside = r2 + (1 - r2) * (1 - r2) * r1 / between;
  const auto answer = [&](double t) { return reflects + passes * passes * t / (1 - reflects_inside * t); };

  SceneBuilder scene;
  const int core = scene.medium(grey(0.6f, 0));
  scene.shape(SphereDescription{{0, 0, 0}, 1}, scene.add(DielectricDescription{.eta = 1.5f}));
  scene.shape(SphereDescription{{0, 0, 0}, 0.8f}, scene.add(DielectricDescription{.eta = 1.33f / 1.5f}));
  scene.interior(core);
  scene.emitter(ConstantEmitterDescription{Rgb{1.0f}});
  scene.look({0, 0, 5}, {0, 0, 0});
  const Measurement m = measure(scene.description(), 16384);
  expect_answer(m, answer(tau));
  expect_rejected(m, answer(std::exp(-0.6 * 2)));  // the wall filled, too
  expect_rejected(m, answer(1));
}

// ---------------------------------------------------------------- the machine around it

TEST(VolumePath, SceneWithoutMediaRunsNoVolumeCode) {
  SceneBuilder plain;
  plain.floor(0, 1, plain.diffuse(0.5f));
  const Scene without(plain.description(), 1);
  EXPECT_NE(dynamic_cast<PathIntegrator*>(make_integrator("path", without).get()), nullptr);
  const Scene with(ball(grey(1, 1), 1).description(), 1);
  EXPECT_NE(dynamic_cast<VolumePathIntegrator*>(make_integrator("path", with).get()), nullptr);
}

TEST(VolumePath, PixelsDoNotDependOnTilesOrThreads) {
  SceneBuilder builder = ball(coloured(2, 0.9f, 0.5f), 1);
  builder.floor(-1, 5, builder.diffuse(0.5f));
  builder.emitter(PointEmitterDescription{{2, 2, 2}, Rgb{9.0f}});
  SceneDescription description = builder.description();
  description.camera.fov_degrees = 30;
  description.film.width = description.film.height = 8;
  const Scene scene(description, 1);
  const auto integrator = make_integrator("path", scene);
  const std::atomic<bool> never{false};
  const auto pixels = [&](int tile, int threads) {
    const FrameResult result = render_frame(scene, *integrator, {{0, 0, 8, 8}, tile, threads, 5, {32, {}, {}}}, never);
    std::vector<double> values;
    for (int i = 0; i < 64; ++i) {
      for (std::uint32_t r = 0; r < kFilmReplicates; ++r) {
        const auto mean = result.film.replicate_mean(i % 8, i / 8, r);
        values.insert(values.end(), {static_cast<double>(mean.r), static_cast<double>(mean.g), static_cast<double>(mean.b)});
      }
    }
    return values;
  };
  EXPECT_EQ(pixels(8, 1), pixels(3, 2));
}

// The features are those of the first surface that is there, seen unscattered.
TEST(VolumePath, FeaturesLookThroughNullBoundaries) {
  SceneBuilder builder = ball(grey(1, 1), 1);
  builder.shape(RectangleDescription{Transform::translate(0, 0, -2) * Transform::scale(9, 9, 1)}, builder.diffuse(0.25f));
  const Scene scene(builder.description(), 1);
  const auto integrator = make_integrator("path", scene);
  RayQueries queries(scene.accelerator());
  std::vector<CameraSample> samples;
  for (std::uint32_t i = 0; i < 64; ++i) samples.push_back({1, 1, i});
  std::vector<SampleResult> results(samples.size());
  integrator->radiance(samples, 1, nullptr, results, queries);
  int unscattered = 0;
  for (const SampleResult& result : results) {
    if (!result.hit) continue;
    ++unscattered;
    EXPECT_EQ(result.albedo, Rgb(0.25f));
    EXPECT_NEAR(result.depth, 7, 1e-4);
  }
  EXPECT_NEAR(unscattered, 64 * std::exp(-2), 10);
}

}  // namespace
}  // namespace fluxfarm::testing
