// Where photons start, where they land and where their flux goes: catalogue P1, P8, and the irradiance that each kind of
// emitter brings, D1, D2, D6, D7.
#include <gtest/gtest.h>

#include <array>
#include <functional>

#include "integrators/photon_scenes.h"
#include "support/error.h"
#include "support/sky.h"

namespace fluxfarm {
namespace {

using testing::cube;
using testing::even_sky;
using testing::kMaxZ;
using testing::kReplicates;
using testing::kTwinZ;
using testing::Measurement;
using testing::replicated;
using testing::SceneBuilder;
using testing::shoot;

constexpr double kPower = 4 * M_PI;  // of a point emitter of intensity one, W

// A closed room with a point light out of its middle.
SceneDescription closed_room(float albedo) {
  SceneBuilder builder;
  builder.shape(cube(Transform::scale(1, 1, 1)), builder.diffuse(albedo), 0, true);
  builder.emitter(PointEmitterDescription{{0.3f, -0.2f, 0.5f}, Rgb{1}});
  return builder.description();
}

// ---------------------------------------------------------------- P1

std::vector<Measurement> arrived_by_bounce(float albedo, std::size_t bounces) {
  const Scene scene(closed_room(albedo), 1);
  std::vector<std::vector<double>> values(bounces);
  for (std::uint64_t seed = 1; seed <= kReplicates; ++seed) {
    const FluxLedger ledger = shoot(scene, {.photons = 20000, .seed = seed}).ledger;
    for (std::size_t i = 0; i < bounces; ++i) values[i].push_back(ledger.arrived[i]);
  }
  std::vector<Measurement> means;
  for (const auto& v : values) means.push_back(testing::summarize(v));
  return means;
}

TEST(PhotonLedger, P1_FluxFallsByTheAlbedoAtEachBounceOfAClosedRoom) {
  const std::vector<Measurement> right = arrived_by_bounce(0.7f, 9), wrong = arrived_by_bounce(0.72f, 9);
  double worst_twin = 0;
  for (std::size_t i = 0; i < right.size(); ++i) {
    const double expected = kPower * std::pow(0.7, static_cast<double>(i));
    EXPECT_LT(right[i].z(expected), kMaxZ) << "bounce " << i << ": " << right[i].mean << " for " << expected;
    worst_twin = std::max(worst_twin, wrong[i].z(expected));
  }
  EXPECT_GT(worst_twin, kTwinZ);  // with another albedo
}

TEST(PhotonLedger, P1_StoredFluxIsWhatArrives) {
  const Scene scene(closed_room(0.7f), 1);
  const ShotPhotons shot = shoot(scene, {.photons = 100000, .seed = 1});
  double stored = 0, arrived = 0;
  for (const Photon& photon : shot.photons) stored += static_cast<double>(mean(photon.light.flux()));
  for (const double flux : shot.ledger.arrived) arrived += flux;
  EXPECT_NEAR(stored / arrived, 1, 1e-4);
}

struct LedgerScene {
  const char* name;
  std::function<void(SceneBuilder&)> build;
};

void room_of(SceneBuilder& builder, MaterialDescription ball) {
  builder.floor(-1, 1, builder.add(DiffuseDescription{{0.8f, 0.5f, 0.2f}}));
  builder.shape(RectangleDescription{Transform::translate(0, 0, -1)}, builder.add(PlasticDescription{}));
  builder.shape(SphereDescription{{0.1f, -0.5f, 0}, 0.45f}, builder.add(std::move(ball)));
}

std::vector<LedgerScene> ledger_scenes() {
  return {
      {"area, glass",
       [](SceneBuilder& b) {
         room_of(b, DielectricDescription{1.5f});
         b.lamp_down(0, 0.9f, 0, 0.5f, 0.5f, b.diffuse(0), 5);
       }},
      {"spot, mirror",
       [](SceneBuilder& b) {
         room_of(b, ConductorDescription{.perfect = true, .specular_reflectance = Rgb{0.9f}});
         b.emitter(SpotEmitterDescription{{0, 1, 0}, {0, -1, 0}, Rgb{1, 2, 3}, 40, 20});
       }},
      {"directional, rough metal",
       [](SceneBuilder& b) {
         room_of(b, RoughConductorDescription{{.perfect = true}, {.alpha_u = 0.3f, .alpha_v = 0.3f}});
         b.emitter(DirectionalEmitterDescription{normalize(Vec3f{0.2f, -1, -0.3f}), Rgb{2}});
       }},
      {"constant, rough glass",
       [](SceneBuilder& b) {
         room_of(b, RoughDielectricDescription{{1.5f}, {.alpha_u = 0.2f, .alpha_v = 0.2f}});
         b.emitter(ConstantEmitterDescription{Rgb{1, 0.5f, 0.2f}});
       }},
      {"envmap, rough plastic",
       [](SceneBuilder& b) {
         room_of(b, RoughPlasticDescription{});
         b.emitter(EnvmapEmitterDescription{testing::patchy_sky(16, 9), {}});
       }},
      {"closed white room",
       [](SceneBuilder& b) {
         b.shape(cube(Transform::scale(1, 1, 1)), b.diffuse(0.98f), 0, true);
         b.emitter(PointEmitterDescription{{0.3f, -0.2f, 0.5f}, Rgb{1}});
       }},
  };
}

TEST(PhotonLedger, P1_BalancesOnEveryScene) {
  for (const LedgerScene& c : ledger_scenes()) {
    SceneBuilder builder;
    c.build(builder);
    const Scene scene(builder.description(), 1);
    double power = 0;
    for (const double watt : ParticleSource::powers(scene)) power += watt;
    std::vector<double> emitted, roulette, kept;
    for (std::uint64_t seed = 1; seed <= kReplicates; ++seed) {
      const FluxLedger l = shoot(scene, {.photons = 4096, .seed = seed}).ledger;
      EXPECT_NEAR((l.absorbed + l.escaped + l.cut + l.ended - l.regained) / l.emitted, 1, 1e-6) << c.name;
      emitted.push_back(l.emitted);
      roulette.push_back(l.ended - l.regained);
      kept.push_back(l.ended);  // twin: survivors that are not divided by their probability
    }
    EXPECT_LT(testing::summarize(emitted).z(power), kMaxZ) << c.name;
    EXPECT_LT(testing::summarize(roulette).z(0), kMaxZ) << c.name;
    EXPECT_GT(testing::summarize(kept).z(0), kTwinZ) << c.name;
  }
}

TEST(PhotonLedger, CountsWhatTheLimitOfBouncesCuts) {
  const Scene scene(closed_room(0.7f), 1);
  const FluxLedger l = shoot(scene, {.photons = 20000, .seed = 1, .max_bounces = 1}).ledger;
  EXPECT_NEAR(l.cut / kPower, 1, 1e-5);
  EXPECT_EQ(l.arrived[1], 0);
}

// ---------------------------------------------------------------- emitters

// Irradiance on a small disk of a black floor at (x, 0, 0), by counting flux.
Measurement irradiance_at(const SceneDescription& description, float x, float radius, std::uint64_t photons) {
  const Scene scene(description, 1);
  return replicated([&](std::uint64_t seed) {
    double flux = 0;
    for (const Photon& photon : shoot(scene, {.photons = photons, .seed = seed}).photons) {
      const Vec3f d = photon.position - Vec3f{x, 0, 0};
      if (photon.light.at_front() && length_squared(d) <= radius * radius) flux += static_cast<double>(photon.light.flux().g);
    }
    return flux / (M_PI * static_cast<double>(radius) * static_cast<double>(radius));
  });
}

struct EmitterCase {
  const char* name;
  std::function<void(SceneBuilder&)> build;
  float x;
  double expected;
};

TEST(PhotonEmission, EachKindOfEmitterBringsTheIrradianceOfItsClosedForm) {
  const std::vector<EmitterCase> cases = {
      {"D1 point",
       [](SceneBuilder& b) {
         b.emitter(PointEmitterDescription{{0, 1, 0}, Rgb{1}});
       },
       1, 0.353553},
      {"spot",
       [](SceneBuilder& b) {
         b.emitter(SpotEmitterDescription{{0, 1, 0}, {0, -1, 0}, Rgb{1}, 60, 50});
       },
       1, 0.353553},
      {"directional",
       [](SceneBuilder& b) {
         b.emitter(DirectionalEmitterDescription{normalize(Vec3f{1, -1, 0}), Rgb{2}});
       },
       0.5f, std::sqrt(2.0)},
      {"D2 rectangle", [](SceneBuilder& b) { b.lamp_down(0, 1, 0, 1, 1, b.diffuse(0), 3); }, 0, 3 * 0.7522747},
      {"D6 sphere",
       [](SceneBuilder& b) {
         b.shape(SphereDescription{{0, 2, 0}, 1}, b.diffuse(0), 2);
       },
       0, 0.25 * M_PI * 2},
      {"D7 constant", [](SceneBuilder& b) { b.emitter(ConstantEmitterDescription{Rgb{0.5f}}); }, 0.3f, M_PI / 2},
      {"D7 envmap",
       [](SceneBuilder& b) {
         b.emitter(EnvmapEmitterDescription{even_sky(0.5f), {}});
       },
       0.3f, M_PI / 2},
      {"emitting triangles",  // of a cube: only its lower face sees the point below
       [](SceneBuilder& b) { b.shape(cube(Transform::translate(0, 1.5, 0) * Transform::scale(0.5, 0.5, 0.5)), b.diffuse(0), 3); },
       0, 3 * 0.7522747},
  };
  for (const EmitterCase& c : cases) {
    SceneBuilder builder;
    builder.floor(0, 2, builder.diffuse(0));
    c.build(builder);
    const Measurement m = irradiance_at(builder.description(), c.x, 0.1f, 60000);
    EXPECT_LT(m.z(c.expected), kMaxZ) << c.name << ": " << m.mean << " +- " << m.standard_error << " for " << c.expected;
    EXPECT_LT(m.standard_error, 0.06 * c.expected) << c.name;
    EXPECT_GT(m.z(c.expected * 1.5), kTwinZ) << c.name;  // as without a factor
  }
}

// Variance of the number of photons on a disk under a point light, over the binomial one.
double disk_variance(const Scene& scene, std::uint64_t photons) {
  const double share = (1 - 1 / std::sqrt(1.25)) / 2;  // of a disk of radius 0.5, 1 below
  std::vector<double> counts;
  for (std::uint64_t seed = 1; seed <= 64; ++seed) {
    double count = 0;
    for (const Photon& photon : shoot(scene, {.photons = photons, .seed = seed, .max_bounces = 1}).photons) {
      count += length_squared(photon.position) <= 0.25f;
    }
    counts.push_back(count);
  }
  const Measurement m = testing::summarize(counts);
  return m.standard_error * m.standard_error * 64 / (static_cast<double>(photons) * share * (1 - share));
}

TEST(PhotonEmission, FillsTheDirectionsEvenly) {
  SceneBuilder builder;
  builder.floor(0, 2, builder.diffuse(0)).emitter(PointEmitterDescription{{0, 1, 0}, Rgb{1}});
  const Scene scene(builder.description(), 1);
  // Independent photons would give 1 +- 0.18.
  EXPECT_LT(disk_variance(scene, 4096), 0.1);
  EXPECT_LT(disk_variance(scene, 5000), 0.2);
  EXPECT_GT(disk_variance(scene, 5000), 0);
}

TEST(PhotonEmission, PhotonsOfOneEmitterAreEquallyStrong) {
  const Scene scene(closed_room(0.7f), 1);
  const ShotPhotons shot = shoot(scene, {.photons = 1000, .seed = 1});
  ASSERT_GT(shot.photons.size(), 1000u);
  for (const Photon& photon : shot.photons) {
    EXPECT_NEAR(static_cast<double>(photon.light.flux().g), kPower / 1000, kPower / 1000 / 127);
  }
}

TEST(PhotonEmission, MoreThanThereIsMemoryForIsRefused) {
  const Scene scene(closed_room(0.7f), 1);
  const PhotonSettings settings{.photons = 1000, .seed = 1};
  const PhotonTracer tracer(scene, settings);
  const std::atomic<bool> never{false};
  const std::size_t stored = shoot(scene, settings).photons.size();
  EXPECT_EQ(shoot_photons(scene, tracer, {0, 1000}, stored, 2, never).photons.size(), stored);
  EXPECT_THROW(shoot_photons(scene, tracer, {0, 1000}, stored - 1, 2, never), ResourceError);
}

// ---------------------------------------------------------------- kinds

TEST(PhotonKinds, FollowWhatTheLightHasMet) {
  SceneBuilder builder;
  builder.floor(0, 5, builder.diffuse(0.5f));
  builder.shape(cube(Transform::translate(0, 1, 0) * Transform::scale(0.5, 0.1, 0.5)), builder.add(DielectricDescription{1.5f}));
  builder.emitter(PointEmitterDescription{{0, 2, 0}, Rgb{1}});
  const Scene scene(builder.description(), 1);
  int direct = 0, caustic = 0, indirect = 0;
  for (const Photon& photon : shoot(scene, {.photons = 50000, .seed = 1}).photons) {
    const Vec3f to_lamp = normalize(Vec3f{0, 2, 0} - photon.position);
    const bool from_lamp = dot(normalize(photon.light.wi()), to_lamp) > 0.99999f;
    direct += photon.light.kind() == PhotonKind::kDirect;
    caustic += photon.light.kind() == PhotonKind::kCaustic;
    indirect += photon.light.kind() == PhotonKind::kIndirect;
    if (photon.light.kind() == PhotonKind::kDirect) {
      EXPECT_TRUE(from_lamp);
      // Not in the shadow of the glass, which is its image on the floor, twice as large.
      EXPECT_GT(std::max(std::fabs(photon.position.x), std::fabs(photon.position.z)), 0.99f);
    }
  }
  EXPECT_GT(direct, 1000);
  EXPECT_GT(caustic, 1000);
  EXPECT_GT(indirect, 10);
  // Those of a caustic map are the caustic ones of the global map.
  EXPECT_EQ(static_cast<int>(shoot(scene, {.photons = 50000, .seed = 1, .kinds = PhotonKind::kCaustic}).photons.size()), caustic);
}

// ---------------------------------------------------------------- same photons

bool same(const std::vector<Photon>& a, const std::vector<Photon>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const Photon& p, const Photon& q) {
           return p.position == q.position && p.light.flux() == q.light.flux() && p.light.wi() == q.light.wi() &&
                  p.light.normal() == q.light.normal() && p.light.kind() == q.light.kind();
         });
}

TEST(PhotonShooting, DoesNotDependOnThreadsOrRanges) {
  const Scene scene(closed_room(0.7f), 1);
  const PhotonSettings settings{.photons = 5 * kPhotonBatch + 77, .seed = 3};
  const ShotPhotons one = shoot(scene, settings, 1), three = shoot(scene, settings, 3);
  EXPECT_TRUE(same(one.photons, three.photons));
  EXPECT_EQ(one.ledger.absorbed, three.ledger.absorbed);
  const PhotonTracer tracer(scene, settings);
  const std::atomic<bool> never{false};
  std::vector<Photon> pieces;
  for (const PhotonRange range : {PhotonRange{0, 2 * kPhotonBatch}, PhotonRange{2 * kPhotonBatch, settings.photons}}) {
    const ShotPhotons piece = shoot_photons(scene, tracer, range, 1 << 20, 2, never);
    pieces.insert(pieces.end(), piece.photons.begin(), piece.photons.end());
  }
  EXPECT_TRUE(same(one.photons, pieces));
  EXPECT_FALSE(same(one.photons, shoot(scene, {.photons = settings.photons, .seed = 4}).photons));
}

TEST(PhotonShooting, P8_MoreThanFourBillionPhotonsChangeNothing) {
  const Scene scene(closed_room(0.7f), 1);
  const std::atomic<bool> never{false};
  constexpr std::uint64_t kAll = std::uint64_t{1} << 34, kBegin = (std::uint64_t{1} << 32) + kPhotonBatch,
                          kCount = 4 * kPhotonBatch;
  const PhotonTracer tracer(scene, {.photons = kAll, .seed = 1});
  const ShotPhotons late = shoot_photons(scene, tracer, {kBegin, kBegin + kCount}, 1 << 20, 2, never);
  const ShotPhotons early = shoot_photons(scene, tracer, {kPhotonBatch, kPhotonBatch + kCount}, 1 << 20, 2, never);
  EXPECT_NEAR(late.ledger.emitted / (kPower * static_cast<double>(kCount) / static_cast<double>(kAll)), 1, 1e-5);
  EXPECT_FALSE(same(late.photons, early.photons));  // as counters of 32 bits would have it
}

TEST(PhotonShooting, WhatMakesNoSenseIsSaid) {
  const auto message = [](const SceneDescription& description, std::uint64_t photons) -> std::string {
    const Scene scene(description, 1);
    try {
      const PhotonTracer tracer(scene, {.photons = photons});
    } catch (const SettingError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(closed_room(0.5f), 1), "");
  EXPECT_NE(message(closed_room(0.5f), 0).find("photons = 0"), std::string::npos);
  SceneBuilder dark;
  dark.floor(0, 1, dark.diffuse(0.5f));
  EXPECT_NE(message(dark.description(), 1).find("nothing in the scene emits"), std::string::npos);
  SceneBuilder mirrors;
  mirrors.floor(0, 1, mirrors.add(ConductorDescription{})).emitter(PointEmitterDescription{{0, 1, 0}, Rgb{1}});
  EXPECT_NE(message(mirrors.description(), 1).find("all surfaces of the scene are smooth"), std::string::npos);
  // A medium that scatters can store them.
  EXPECT_EQ(message(mirrors.camera_in(mirrors.medium({})).description(), 1), "");
  SceneBuilder fog;
  fog.floor(0, 1, fog.diffuse(0.5f)).emitter(PointEmitterDescription{{0, 1, 0}, Rgb{1}}).camera_in(fog.medium({}));
  const Scene foggy(fog.description(), 1);
  EXPECT_THROW(make_integrator("photon", foggy), SettingError);
}

TEST(PhotonShooting, MemoryHasABudget) {
  const Scene scene(closed_room(0.7f), 1);
  const std::atomic<bool> never{false};
  const PhotonTracer tracer(scene, {.photons = 10000, .seed = 1});
  EXPECT_THROW(shoot_photons(scene, tracer, {0, 10000}, 5000, 2, never), ResourceError);
  const std::atomic<bool> cancelled{true};
  EXPECT_THROW(shoot_photons(scene, tracer, {0, 10000}, 1 << 20, 2, cancelled), CancelledError);
}

}  // namespace
}  // namespace fluxfarm
