// Lights that only next-event estimation finds: what arrives, the power that the choice of emitters goes by, and twins that must
// fail.
#include <gtest/gtest.h>

#include "emitters/directional_emitter.h"
#include "emitters/spot_emitter.h"

namespace fluxfarm::testing {
namespace {

constexpr float kRadians = kPi / 180;

SpotEmitter spot(float cutoff_degrees, float beam_degrees) {
  return {{0, 0, 0}, {0, 0, 1}, Rgb{2.0f}, cutoff_degrees * kRadians, beam_degrees * kRadians};
}

// Irradiance at distance 2 and at that angle to the axis, zero where nothing arrives.
float arriving(const SpotEmitter& light, float degrees) {
  const Vec3f reference{2 * std::sin(degrees * kRadians), 0, 2 * std::cos(degrees * kRadians)};
  const auto sample = light.sample(reference, {});
  return sample ? sample->weight.g : 0;
}

TEST(SpotEmitter, FallsOffLinearlyInTheAngle) {
  // Mitsuba 3.6.4 gives 1, 1, 0.9, 0.5, 0.1, 0 for unit intensity at distance 1.
  const SpotEmitter light = spot(40, 30);
  for (const auto& [degrees, share] :
       {std::pair{10.0f, 1.0f}, {29.0f, 1.0f}, {31.0f, 0.9f}, {35.0f, 0.5f}, {39.0f, 0.1f}, {41.0f, 0.0f}, {180.0f, 0.0f}}) {
    EXPECT_NEAR(arriving(light, degrees), 2 * share / 4, 1e-5f) << degrees;
  }
}

TEST(SpotEmitter, WithoutASlopeIsCutSharply) {
  EXPECT_FLOAT_EQ(arriving(spot(30, 30), 29.9f), 0.5f);
  EXPECT_EQ(arriving(spot(30, 30), 30.1f), 0);
}

TEST(SpotEmitter, KeepsItsDigitsInANarrowBeam) { EXPECT_NEAR(arriving(spot(0.1f, 0.05f), 0.075f), 0.25f, 1e-4f); }

TEST(SpotEmitter, PowerIsTheIntegralOfItsIntensity) {
  for (const auto& [cutoff, beam] : {std::pair{20.0f, 15.0f}, {40.0f, 0.0f}, {170.0f, 30.0f}, {60.0f, 60.0f}, {1.0f, 0.5f}}) {
    const SpotEmitter light = spot(cutoff, beam);
    constexpr int kSteps = 100000;
    const double step = static_cast<double>(cutoff * kRadians) / kSteps;
    double power = 0, uniform_cone = 0;
    for (int i = 0; i < kSteps; ++i) {
      const double theta = (i + 0.5) * step, ring = 2 * M_PI * std::sin(theta) * step;
      const Vec3f direction{static_cast<float>(std::sin(theta)), 0, static_cast<float>(std::cos(theta))};
      power += 2 * static_cast<double>(light.falloff(direction)) * ring;
      uniform_cone += 2 * ring;
    }
    EXPECT_NEAR(static_cast<double>(light.power().g), power, 1e-3 * power) << cutoff;
    EXPECT_EQ(uniform_cone > 1.1 * power, beam < cutoff) << "the twin without fall-off is told apart";
  }
}

// A cone so narrow that the float cosine of its cut-off has a digit or two left.
TEST(SpotEmitter, EmitsItsPowerInANarrowBeam) {
  for (const float cutoff : {0.03f, 0.1f, 30.0f}) {
    const SpotEmitter light = spot(cutoff, cutoff);
    const double angle = static_cast<double>(cutoff * kRadians), power = 2 * M_PI * 2 * 2 * std::pow(std::sin(angle / 2), 2);
    double flux = 0, widest = 0;
    constexpr int kSteps = 100;
    for (int i = 0; i < kSteps * kSteps; ++i) {
      const Vec2f u{(static_cast<float>(i % kSteps) + 0.5f) / kSteps, (static_cast<float>(i / kSteps) + 0.5f) / kSteps};
      const auto emission = light.emit({}, u, {});
      if (!emission) continue;
      flux += static_cast<double>(emission->flux.g) / (kSteps * kSteps);
      widest = std::max(widest, static_cast<double>(std::hypot(emission->ray.direction.x, emission->ray.direction.y)));
    }
    EXPECT_NEAR(flux, power, 1e-4 * power) << cutoff;
    EXPECT_NEAR(widest, std::sin(angle), 0.02 * std::sin(angle)) << cutoff;
  }
  // Twin: one less the cosine, in floats.
  const float lost = 1 - std::cos(0.03f * kRadians);
  EXPECT_GT(std::abs(static_cast<double>(lost) / (2 * std::pow(std::sin(0.015 * M_PI / 180), 2)) - 1), 0.01);
}

TEST(DirectionalEmitter, BringsTheSameLightEverywhere) {
  const DirectionalEmitter light({0, -1, 0}, Rgb{3.0f}, 2);
  for (const Vec3f reference : {Vec3f{0, 0, 0}, Vec3f{1e6f, 5, -2}}) {
    const auto sample = light.sample(reference, {});
    ASSERT_TRUE(sample);
    EXPECT_EQ(sample->wi, (Vec3f{0, 1, 0}));
    EXPECT_EQ(sample->weight, Rgb{3.0f});
    EXPECT_EQ(sample->distance, kDistant);
    EXPECT_TRUE(sample->delta);
  }
  EXPECT_NEAR(light.power().g, 3 * kPi * 4, 1e-4f);
}

}  // namespace
}  // namespace fluxfarm::testing
