// Caustics with closed forms: catalogue C1, C2, C3, C7.
#include <gtest/gtest.h>

#include <cmath>

#include "integrators/photon/density_estimate.h"
#include "integrators/photon/density_kernel.h"
#include "integrators/photon_scenes.h"

namespace fluxfarm {
namespace {

using testing::cube;
using testing::kMaxZ;
using testing::kTwinZ;
using testing::Measurement;
using testing::replicated;
using testing::SceneBuilder;
using testing::shoot;

// A point light of intensity one that shines down into a cone of that half angle.
SpotEmitterDescription lamp(float height, float cutoff_degrees) {
  return {{0, height, 0}, {0, -1, 0}, Rgb{1}, cutoff_degrees, cutoff_degrees};
}

// Caustic irradiance on the screen y = 0 at (x, 0, 0).
Measurement caustic_at(const SceneDescription& description, float x, float radius, int max_bounces, std::uint64_t photons) {
  const Scene scene(description, 1);
  return replicated([&](std::uint64_t seed) {
    const PhotonSettings settings{.photons = photons, .seed = seed, .max_bounces = max_bounces, .kinds = PhotonKind::kCaustic};
    const PhotonMap map(shoot(scene, settings).photons, 2);
    const SurfacePatch patch({x, 0, 0}, {0, 1, 0}, PhotonSide::kFront, radius);
    return static_cast<double>(estimate_within(map, patch, radius, EpanechnikovKernel{}).value.g);
  });
}

TEST(PhotonCaustics, C1_PlaneMirrorMakesASecondLamp) {
  // The lamp shines up at a mirror 1.5 above the screen from 0.5 above it: its image stands 2.5 above.
  SceneBuilder builder;
  builder.floor(0, 3, builder.diffuse(0));
  builder.shape(
      RectangleDescription{Transform::translate(0, 1.5, 0) * Transform::rotate(1, 0, 0, 90) * Transform::scale(0.5, 0.5, 1)},
      builder.add(ConductorDescription{.perfect = true, .specular_reflectance = Rgb{0.8f}}));
  builder.emitter(SpotEmitterDescription{{0, 0.5f, 0}, {0, 1, 0}, Rgb{1}, 35, 35});
  const Measurement m = caustic_at(builder.description(), 0, 0.1f, -1, 120000);
  const double expected = 0.8 / (2.5 * 2.5);
  EXPECT_LT(m.z(expected), kMaxZ) << m.mean << " for " << expected;
  EXPECT_LT(m.standard_error, 0.02 * expected);
  EXPECT_GT(m.z(expected / 0.8), kTwinZ);
  // Cut where the mirror ends, seen from the image: at 0.5 * 2.5.
  EXPECT_GT(caustic_at(builder.description(), 1.1f, 0.1f, -1, 120000).mean, 0.05);
  EXPECT_EQ(caustic_at(builder.description(), 1.4f, 0.1f, -1, 120000).mean, 0);
}

// Screen at 0, slab of glass from 1 to 1.5, lamp at 2.5.
constexpr double kIndex = 1.5, kHeights = 2, kThickness = 0.5;

SceneDescription slab(float cutoff_degrees) {
  SceneBuilder builder;
  builder.floor(0, 20, builder.diffuse(0));
  builder.shape(cube(Transform::translate(0, 1.25, 0) * Transform::scale(20, 0.25, 20)),
                builder.add(DielectricDescription{static_cast<float>(kIndex)}));
  builder.emitter(lamp(2.5f, cutoff_degrees));
  return builder.description();
}

TEST(PhotonCaustics, C2_SlabOfGlassOnTheAxis) {
  const double reflectance = std::pow((kIndex - 1) / (kIndex + 1), 2), passes = std::pow(1 - reflectance, 2);
  double all = 0;  // each pair of inner reflections adds a farther lamp
  for (int pair = 0; pair < 6; ++pair) {
    all += passes * std::pow(reflectance, 2 * pair) / std::pow(kHeights + (2 * pair + 1) * kThickness / kIndex, 2);
  }
  const Measurement m = caustic_at(slab(10), 0, 0.1f, -1, 60000), single = caustic_at(slab(10), 0, 0.1f, 3, 60000);
  EXPECT_LT(m.z(all), kMaxZ) << m.mean << " for " << all;
  EXPECT_LT(single.z(0.169273), kMaxZ) << single.mean;
  EXPECT_LT(m.standard_error, 0.005 * all);
  EXPECT_GT(m.z(0.16), kTwinZ);  // straight on, as if the slab did not bring the lamp nearer
}

TEST(PhotonCaustics, C3_SlabOfGlassOffTheAxis) {
  const double angle = M_PI / 6;
  const auto ring = [](double outside) {
    return kHeights * std::tan(outside) + kThickness * std::tan(std::asin(std::sin(outside) / kIndex));
  };
  const double inside = std::asin(std::sin(angle) / kIndex);
  const double s = std::pow((std::cos(angle) - kIndex * std::cos(inside)) / (std::cos(angle) + kIndex * std::cos(inside)), 2);
  const double p = std::pow((kIndex * std::cos(angle) - std::cos(inside)) / (kIndex * std::cos(angle) + std::cos(inside)), 2);
  const double passes = 1 - (s + p) / 2;  // of unpolarised light at each face
  const double slope = (ring(angle + 1e-5) - ring(angle - 1e-5)) / 2e-5;
  const double expected = passes * passes * std::sin(angle) / (ring(angle) * slope);
  const Measurement m = caustic_at(slab(40), static_cast<float>(ring(angle)), 0.1f, 3, 200000);
  EXPECT_LT(m.z(expected), kMaxZ) << m.mean << " for " << expected;
  EXPECT_LT(m.standard_error, 0.02 * expected);
  EXPECT_GT(m.z(expected * 1.25), kTwinZ);
}

TEST(PhotonCaustics, C7_GlassNeitherMakesNorLosesFlux) {
  SceneBuilder builder;
  builder.floor(0, 20, builder.diffuse(0));
  builder.shape(SphereDescription{{0, 1, 0}, 0.5f}, builder.add(DielectricDescription{1.5f}));
  builder.emitter(lamp(3, 10));  // all of it meets the ball
  const Scene scene(builder.description(), 1);
  double emitted = 0;
  const Measurement m = replicated([&](std::uint64_t seed) {
    const ShotPhotons shot = shoot(scene, {.photons = 20000, .seed = seed});
    double flux = shot.ledger.escaped;  // reflected up
    for (const Photon& photon : shot.photons) {
      EXPECT_EQ(photon.light.kind(), PhotonKind::kCaustic);
      flux += static_cast<double>(photon.light.flux().g);
    }
    emitted = shot.ledger.emitted;
    return flux;
  });
  EXPECT_LT(m.z(emitted), kMaxZ) << m.mean << " of " << emitted;
  EXPECT_LT(m.standard_error, 0.002 * emitted);
}

}  // namespace
}  // namespace fluxfarm
