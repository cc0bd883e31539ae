// Photons in media: their ledger, catalogue P1, the media that they start in, and the estimates of catalogue M6.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "integrators/photon/volume_estimate.h"
#include "integrators/photon_scenes.h"
#include "support/sky.h"

namespace fluxfarm {
namespace {

using testing::cube;
using testing::kMaxZ;
using testing::kReplicates;
using testing::kTwinZ;
using testing::Measurement;
using testing::replicated;
using testing::SceneBuilder;
using testing::shoot;
using testing::summarize;

constexpr double kPower = 4 * M_PI;  // of a point emitter of intensity one, W
constexpr std::array<float, 3> kSigma{0.4f, 1, 2.5f}, kAlbedo{1, 0.8f, 0.4f};

HomogeneousMediumDescription grey(float sigma_t, float albedo, float g = 0) { return {Rgb{sigma_t}, Rgb{albedo}, g}; }
HomogeneousMediumDescription coloured(float g = 0) {
  return {{kSigma[0], kSigma[1], kSigma[2]}, {kAlbedo[0], kAlbedo[1], kAlbedo[2]}, g};
}

template <typename Value>
double mean_of_channels(Value&& value) {
  return (value(0) + value(1) + value(2)) / 3;
}

// A point light in a medium so large that no light comes out of it.
SceneDescription endless(const HomogeneousMediumDescription& medium) {
  SceneBuilder builder;
  builder.shape(SphereDescription{{0, 0, 0}, 500}, builder.diffuse(0), 0, true);
  builder.emitter(PointEmitterDescription{{0.3f, -0.2f, 0.5f}, Rgb{1}});
  builder.camera_in(builder.medium(medium));
  return builder.description();
}

// A ball of a medium behind a null boundary, and a speck that photons could be stored on.
SceneBuilder ball(const HomogeneousMediumDescription& medium, float radius) {
  SceneBuilder builder;
  builder.floor(-1.5f, 1e-3f, builder.diffuse(0));
  builder.shape(SphereDescription{{0, 0, 0}, radius}, builder.add(NullDescription{}));
  builder.interior(builder.medium(medium));
  return builder;
}

Measurement of_ledger(const SceneDescription& description, double FluxLedger::*entry, std::uint64_t photons = 20000) {
  const Scene scene(description, 1);
  return replicated([&](std::uint64_t seed) { return shoot(scene, {.photons = photons, .seed = seed}).ledger.*entry; });
}

// ---------------------------------------------------------------- P1

TEST(VolumePhotons, P1_FluxFallsByTheAlbedoAtEachCollision) {
  for (const bool colour : {false, true}) {
    const Scene scene(endless(colour ? coloured(0.3f) : grey(1, 0.7f, 0.3f)), 1);
    double worst_twin = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      const Measurement m = replicated(
          [&](std::uint64_t seed) { return shoot(scene, {.photons = 4000, .seed = seed, .max_bounces = 7}).ledger.arrived[i]; });
      const auto power = static_cast<double>(i);
      const double mean_albedo = mean_of_channels([](std::size_t c) { return static_cast<double>(kAlbedo[c]); });
      const double expected =
          kPower * (colour ? mean_of_channels([&](std::size_t c) { return std::pow(static_cast<double>(kAlbedo[c]), power); })
                           : std::pow(0.7, power));
      EXPECT_LT(m.z(expected), kMaxZ) << "collision " << i << ": " << m.mean << " +- " << m.standard_error << " for " << expected;
      worst_twin = std::max(worst_twin, m.z(kPower * std::pow(colour ? mean_albedo : 0.73, power)));
    }
    EXPECT_GT(worst_twin, kTwinZ) << colour;  // with another albedo, or one that has lost its colour
  }
}

TEST(VolumePhotons, P1_StoredFluxIsWhatCollisionsScatter) {
  const Scene scene(endless(grey(1, 0.7f)), 1);
  const ShotPhotons shot = shoot(scene, {.photons = 30000, .seed = 1});
  double stored = 0, arrived = 0;
  for (const Photon& photon : shot.in_media) stored += static_cast<double>(mean(photon.light.flux()));
  for (const double flux : shot.ledger.arrived) arrived += flux;
  EXPECT_NEAR(stored / (0.7 * arrived), 1, 2e-4);
  EXPECT_TRUE(shot.photons.empty());
}

TEST(VolumePhotons, P1_WhatIsNotAbsorbedEscapes) {
  for (const bool colour : {false, true}) {
    SceneBuilder builder = ball(colour ? HomogeneousMediumDescription{{0.4f, 1, 2.5f}, Rgb{0.0f}, 0} : grey(1, 0), 1.2f);
    builder.emitter(PointEmitterDescription{{0, 0, 0}, Rgb{1}}).look({0, 0, 5}, {0, 0, 0});
    const auto left = [&](std::size_t c) { return std::exp(-1.2 * (colour ? static_cast<double>(kSigma[c]) : 1.0)); };
    const double expected = kPower * mean_of_channels(left);
    const Measurement m = of_ledger(builder.description(), &FluxLedger::escaped);
    EXPECT_LT(m.z(expected), kMaxZ) << m.mean << " +- " << m.standard_error << " for " << expected;
    const double twin = colour ? std::exp(-1.2 * (0.4 + 1 + 2.5) / 3) : std::exp(-1.2 * 1.05);
    EXPECT_GT(m.z(kPower * twin), kTwinZ);
  }
}

TEST(VolumePhotons, P1_NullBoundariesAreNoEvents) {
  const auto shot_in = [](bool bubble) {
    SceneBuilder builder;
    builder.shape(cube(Transform::scale(1, 1, 1)), builder.diffuse(0.7f), 0, true);
    if (bubble) builder.shape(SphereDescription{{0.3f, -0.2f, 0.5f}, 0.3f}, builder.add(NullDescription{}));
    builder.emitter(PointEmitterDescription{{0.3f, -0.2f, 0.5f}, Rgb{1}});
    const Scene scene(builder.description(), 1);
    return shoot(scene, {.photons = 5000, .seed = 1, .max_bounces = 3});
  };
  const ShotPhotons with = shot_in(true), without = shot_in(false);
  EXPECT_EQ(with.photons.size(), without.photons.size());
  EXPECT_NEAR(with.ledger.cut / without.ledger.cut, 1, 1e-3);
  EXPECT_NEAR(with.ledger.arrived[0] / kPower, 1, 1e-5);
  EXPECT_GT(with.rays, without.rays);  // it was in the way
}

TEST(VolumePhotons, P1_BalancesInMedia) {
  for (const float g : {0.0f, 0.8f}) {
    SceneBuilder builder;
    builder.floor(-1, 2, builder.add(DiffuseDescription{{0.8f, 0.5f, 0.2f}}));
    const int fog = builder.medium(coloured(g));
    builder.shape(SphereDescription{{0.1f, -0.5f, 0}, 0.45f}, builder.add(DielectricDescription{1.5f}));
    builder.interior(builder.medium(grey(0.5f, 0.9f)));
    builder.shape(SphereDescription{{0, 0, 0}, 3}, builder.add(NullDescription{}));
    builder.interior(fog);
    builder.lamp_down(0, 0.9f, 0, 0.5f, 0.5f, builder.diffuse(0), 5);
    builder.emitter(EnvmapEmitterDescription{testing::patchy_sky(16, 9), {}});
    builder.look({0, 0, 9}, {0, 0, 0});
    const Scene scene(builder.description(), 1);
    double power = 0;
    for (const double watt : ParticleSource::powers(scene)) power += watt;
    std::vector<double> emitted, roulette, kept;
    for (std::uint64_t seed = 1; seed <= kReplicates; ++seed) {
      const FluxLedger l = shoot(scene, {.photons = 4096, .seed = seed}).ledger;
      EXPECT_NEAR((l.absorbed + l.escaped + l.cut + l.ended - l.regained) / l.emitted, 1, 1e-6) << g;
      emitted.push_back(l.emitted);
      roulette.push_back(l.ended - l.regained);
      kept.push_back(l.ended);  // twin: survivors that are not divided by their probability
    }
    EXPECT_LT(summarize(emitted).z(power), kMaxZ) << g;
    EXPECT_LT(summarize(roulette).z(0), kMaxZ) << g;
    EXPECT_GT(summarize(kept).z(0), kTwinZ) << g;
  }
}

// ---------------------------------------------------------------- where light starts

TEST(VolumePhotons, StartInTheMediumAroundTheirEmitter) {
  constexpr double kThick = 3;
  const auto fog = grey(static_cast<float>(kThick), 0);
  const auto escaped = [&](auto&& emitter, const std::array<double, 3>& from, bool camera_inside) {
    SceneBuilder builder = ball(fog, 1);
    emitter(builder);
    builder.look(from, {0, 0, 0});
    if (camera_inside) builder.camera_in(0);
    return of_ledger(builder.description(), &FluxLedger::escaped);
  };
  const auto inside = [](SceneBuilder& b) { b.emitter(PointEmitterDescription{{0, 0, 0}, Rgb{1}}); };
  for (const bool camera_inside : {false, true}) {
    const Measurement m = escaped(inside, {0, 0, camera_inside ? 0.5 : 5.0}, camera_inside);
    EXPECT_LT(m.z(kPower * std::exp(-kThick)), kMaxZ) << m.mean;
    EXPECT_GT(m.z(kPower), kTwinZ);  // as if it started outside
  }
  // Next to the ball: what does not meet it escapes, and little of the rest.
  const auto outside = [](SceneBuilder& b) { b.emitter(PointEmitterDescription{{2, 0, 0}, Rgb{1}}); };
  const double passes_by = (1 + std::sqrt(0.75)) / 2;
  for (const bool camera_inside : {false, true}) {
    const Measurement m = escaped(outside, {0, 0, camera_inside ? 0.5 : 5.0}, camera_inside);
    EXPECT_GT(m.mean, kPower * passes_by);
    EXPECT_LT(m.mean, kPower * (1 + passes_by) / 2);
  }
  // A lamp without media of its own, with one end in the ball.
  const auto lamp = [](SceneBuilder& b) { b.lamp_down(1, 0, 0, 2, 0.01f, b.diffuse(0), static_cast<float>(4 / 0.02)); };
  const Measurement m = escaped(lamp, {0, 0, 5}, false);
  EXPECT_GT(m.mean, 0.45 * kPower);
  EXPECT_LT(m.mean, 0.6 * kPower);
}

TEST(VolumePhotons, LightFromOutsideIsLostInAMediumWithoutEnd) {
  SceneBuilder builder;
  builder.floor(0, 1, builder.diffuse(0.5f)).emitter(ConstantEmitterDescription{Rgb{1}});
  builder.emitter(DirectionalEmitterDescription{{0, -1, 0}, Rgb{1}});
  builder.camera_in(builder.medium({{0, 1, 1}, Rgb{0.5f}, 0})).look({0, 1, 1}, {0, 0, 0});
  const Scene scene(builder.description(), 1);
  const ShotPhotons shot = shoot(scene, {.photons = 5000, .seed = 1});
  EXPECT_TRUE(shot.in_media.empty());
  ASSERT_FALSE(shot.photons.empty());  // but for the clear channel
  for (const Photon& photon : shot.photons) {
    EXPECT_GT(photon.light.flux().r, 0);
    EXPECT_EQ(photon.light.flux().g, 0);
  }
}

// ---------------------------------------------------------------- the beam

Photon photon_in(Vec3f position, float flux, Vec3f wi, float dither) {
  return {position, PhotonLight::in_medium(Rgb{flux}, wi, PhotonKind::kCaustic, 2, dither)};
}

// Evenly over a cube of side two, light from all directions, one watt for each m^3.
PhotonMap even_cube(std::size_t count, std::uint64_t seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<Photon> photons;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f p{2 * unit(random) - 1, 2 * unit(random) - 1, 2 * unit(random) - 1};
    const Vec3f wi = square_to_uniform_sphere({unit(random), unit(random)});
    photons.push_back(photon_in(p, 8 / static_cast<float>(count), wi, unit(random)));
  }
  return PhotonMap(photons, 2);
}

TEST(VolumePhotons, BeamsFindAllPhotonsInThem) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0, 1);
  for (const std::size_t size : {0, 1, 16, 17, 100, 1000, 5000}) {
    std::vector<Photon> photons;
    for (std::size_t i = 0; i < size; ++i) {
      const Vec3f p{unit(random), unit(random) * unit(random), unit(random) < 0.3f ? 0.5f : unit(random)};
      photons.push_back(photon_in(p, static_cast<float>(i % 128 + 128), {0, 1, 0}, 0));
    }
    const PhotonMap map(photons, 2);
    for (int trial = 0; trial < 200; ++trial) {
      Beam beam{{3 * unit(random) - 1, 3 * unit(random) - 1, 3 * unit(random) - 1},
                square_to_uniform_sphere({unit(random), unit(random)}),
                trial % 3 == 0 ? std::numeric_limits<float>::infinity() : 2 * unit(random),
                0.2f * unit(random),
                trial % 2 == 0 ? 0 : 0.3f * unit(random)};
      if (trial % 5 == 0) beam.direction = {0, trial % 2 == 0 ? 1.0f : -1.0f, 0};  // along an axis
      std::vector<float> found, expected;
      map.for_each_in(beam, [&](float, float, const PhotonLight& light) { found.push_back(light.flux().g); });
      for (const Photon& photon : photons) {
        const Vec3f d = photon.position - beam.origin;
        const float along = dot(d, beam.direction);
        if (along < 0 || along > beam.length) continue;
        if (length_squared(d - along * beam.direction) <= sqr(beam.radius_at(along))) expected.push_back(photon.light.flux().g);
      }
      std::ranges::sort(found);
      std::ranges::sort(expected);
      ASSERT_EQ(found, expected) << size << " " << trial;
    }
  }
}

// ---------------------------------------------------------------- M6

// What each metre of a ray in `direction` gets at `place`, W m^-3 sr^-1, by the photons in a ball.
//
// [Jensen98] H. W. Jensen, P. H. Christensen, "Efficient Simulation of Light Transport in Scenes with Participating Media using
// Photon Maps", SIGGRAPH 1998.
Rgb scattered_within(const PhotonMap& map, Vec3f place, float radius, const PhaseFunction& phase, Vec3f direction) {
  Rgb sum;
  map.for_each_within(place, radius, [&](Vec3f d, const PhotonLight& light) {
    const float weight = 2.5f * (1 - length_squared(d) / (radius * radius));  // of mean one over the ball
    sum += light.flux() * (weight * phase.value(direction, normalize(light.wi())));
  });
  return sum / (4 * kPi / 3 * radius * radius * radius);
}

TEST(VolumePhotons, M6_BallAndBeamAreExactInAnEvenField) {
  std::vector<PhotonMap> maps;
  for (std::uint64_t seed = 1; seed <= kReplicates; ++seed) maps.push_back(even_cube(200000, seed));
  for (const float g : {0.0f, 0.5f}) {
    const HomogeneousMedium medium(grey(0.8f, 1, g));
    const Vec3f direction = normalize(Vec3f{0.6f, 0.3f, 0.5f});
    const Measurement in_ball = replicated([&](std::uint64_t seed) {
      return static_cast<double>(scattered_within(maps[seed - 1], {0.1f, -0.2f, 0}, 0.4f, medium.phase(), direction).g);
    });
    const auto along = [&](float radius, float spread) {
      return replicated([&](std::uint64_t seed) {
        const Beam beam{Vec3f{-0.3f, -0.2f, -0.4f}, direction, 0.9f, radius, spread};
        return static_cast<double>(scattered_along(maps[seed - 1], beam, medium, 9).value.g);
      });
    };
    const double each_metre = 1 / (4 * M_PI), on_the_way = each_metre * (1 - std::exp(-0.8 * 0.9)) / 0.8;
    EXPECT_LT(in_ball.z(each_metre), kMaxZ) << in_ball.mean << " for " << each_metre;
    EXPECT_LT(in_ball.standard_error, 0.01 * each_metre);
    EXPECT_GT(in_ball.z(each_metre * 0.8), kTwinZ);  // the disk's constant
    for (const Measurement& in_beam : {along(0.25f, 0), along(0.1f, 0.2f)}) {
      EXPECT_LT(in_beam.z(on_the_way), kMaxZ) << in_beam.mean << " for " << on_the_way;
      EXPECT_LT(in_beam.standard_error, 0.015 * on_the_way);
      EXPECT_GT(in_beam.z(on_the_way * 1.25), kTwinZ);  // the ball's constant
      EXPECT_GT(in_beam.z(each_metre * 0.9), kTwinZ);   // no extinction
      EXPECT_NEAR(in_beam.mean / in_ball.mean, on_the_way / each_metre,
                  kMaxZ * std::hypot(in_beam.standard_error, in_ball.standard_error) / in_ball.mean);
    }
  }
}

// The same with light that was shot: under an even sky the radiance in a medium that absorbs nothing is that of the sky (M3).
TEST(VolumePhotons, M6_AnEvenSkyInAMediumThatAbsorbsNothing) {
  SceneBuilder builder = ball({{0.5f, 1, 2}, Rgb{1}, 0.4f}, 1);
  builder.emitter(ConstantEmitterDescription{Rgb{1}}).look({0, 0, 5}, {0, 0, 0});
  const Scene scene(builder.description(), 1);
  const HomogeneousMedium& medium = scene.media().front();
  std::vector<PhotonMap> maps;
  for (std::uint64_t seed = 1; seed <= kReplicates; ++seed) {
    maps.emplace_back(shoot(scene, {.photons = 50000, .seed = seed}).in_media, 2);
  }
  for (int channel = 0; channel < 3; ++channel) {
    const auto pick = [&](Rgb value) { return static_cast<double>(channel == 0 ? value.r : channel == 1 ? value.g : value.b); };
    const double sigma = pick(medium.sigma_s());
    const Measurement in_ball = replicated([&](std::uint64_t seed) {
      return pick(scattered_within(maps[seed - 1], {0.1f, 0.2f, 0}, 0.5f, medium.phase(), {0, 0, 1}));
    });
    const Measurement in_beam = replicated([&](std::uint64_t seed) {
      return pick(scattered_along(maps[seed - 1], {{0, 0, -0.8f}, {0, 0, 1}, 1.6f, 0.2f, 0}, medium, 32).value);
    });
    EXPECT_LT(in_ball.z(sigma), kMaxZ) << channel << ": " << in_ball.mean << " +- " << in_ball.standard_error;
    EXPECT_GT(in_ball.z(sigma * 0.8), kTwinZ);
    const double expected = 1 - std::exp(-1.6 * sigma);
    EXPECT_LT(in_beam.z(expected), kMaxZ) << channel << ": " << in_beam.mean << " +- " << in_beam.standard_error;
    EXPECT_GT(in_beam.z(expected * 1.25), kTwinZ);
  }
}

}  // namespace
}  // namespace fluxfarm
