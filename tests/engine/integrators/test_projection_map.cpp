// Projection maps: no light that makes a caustic is masked, none is lost or gained, and the photons go where they are of use.
// Catalogue P1, P9, 4.4 (few photons).
#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <string_view>

#include "integrators/photon/bounding_balls.h"
#include "integrators/photon/projection_pilot.h"
#include "integrators/photon_scenes.h"
#include "support/error.h"
#include "support/sky.h"

namespace fluxfarm {
namespace {

using testing::cube;
using testing::kMaxZ;
using testing::kReplicates;
using testing::kTwinZ;
using testing::Measurement;
using testing::SceneBuilder;

enum class Projection { kNone, kMask, kMeasured };

PhotonSettings caustic(std::uint64_t photons, std::uint64_t seed) {
  return {.photons = photons, .seed = seed, .kinds = PhotonKind::kCaustic};
}

ProjectionMap caustic_projection(const Scene& scene) { return {scene, bounding_balls(scene, glossy_shapes(scene))}; }

ProjectionMap measured_projection(const Scene& scene) {
  ProjectionMap map = caustic_projection(scene);
  follow_measured_use(scene, caustic(1, 1), map);
  return map;
}

ShotPhotons shoot(const Scene& scene, const PhotonSettings& settings, const ProjectionMap* map, int threads = 2) {
  static const std::atomic<bool> never{false};
  const PhotonTracer tracer = map != nullptr ? PhotonTracer(scene, settings, *map) : PhotonTracer(scene, settings);
  return shoot_photons(scene, tracer, {0, settings.photons}, std::size_t{1} << 26, threads, never);
}

// Something of each shape that bends light, out of the middle, over a floor that shows it.
SceneBuilder things() {
  SceneBuilder b;
  b.floor(0, 2, b.diffuse(0.5f));
  const int glass = b.add(DielectricDescription{1.5f}), mirror = b.add(ConductorDescription{.perfect = true});
  b.shape(SphereDescription{{0.5f, 0.6f, 0.3f}, 0.2f}, glass);
  b.shape(cube(Transform::translate(-0.6, 0.5, 0.2) * Transform::rotate(1, 1, 0, 30) * Transform::scale(0.2, 0.05, 0.2)), glass);
  b.shape(
      RectangleDescription{Transform::translate(0, 0.3, -0.8) * Transform::rotate(1, 0, 0, -20) * Transform::scale(0.3, 0.1, 1)},
      mirror);
  return b;
}

struct EmitterCase {
  const char* name;
  SceneDescription scene;
  bool too_large = false;  // in the sky for caustics that photons would carry: paths find that light
};

std::vector<EmitterCase> emitter_cases() {
  std::vector<EmitterCase> cases;
  const auto add = [&](const char* name, const std::function<void(SceneBuilder&)>& build) {
    SceneBuilder b = things();
    build(b);
    cases.push_back({name, b.description(), std::string_view(name) == "constant" || std::string_view(name) == "environment map"});
  };
  add("point", [](SceneBuilder& b) { b.emitter(PointEmitterDescription{{0.1f, 2, -0.2f}, Rgb{1}}); });
  add("spot with a slope", [](SceneBuilder& b) {
    b.emitter(SpotEmitterDescription{{1, 2, 1}, normalize(Vec3f{-0.4f, -1, -0.5f}), Rgb{1, 2, 3}, 40, 10});
  });
  add("directional", [](SceneBuilder& b) { b.emitter(DirectionalEmitterDescription{normalize(Vec3f{0.4f, -1, 0.2f}), Rgb{2}}); });
  add("constant", [](SceneBuilder& b) { b.emitter(ConstantEmitterDescription{Rgb{1, 0.5f, 0.2f}}); });
  add("environment map", [](SceneBuilder& b) {
    b.emitter(EnvmapEmitterDescription{testing::patchy_sky(16, 9), Transform::rotate(1, 0.5, 0.2, 40)});
  });
  add("sun in an environment map", [](SceneBuilder& b) { b.emitter(EnvmapEmitterDescription{testing::sunny_sky(), {}}); });
  add("rectangle", [](SceneBuilder& b) { b.lamp_down(0.2f, 2, 0.1f, 0.5f, 0.3f, b.diffuse(0), 5); });
  add("rectangle of two sides", [](SceneBuilder& b) {
    b.shape(
        RectangleDescription{Transform::translate(-0.1, 1.3, 0) * Transform::rotate(1, 2, 0, 35) * Transform::scale(0.3, 0.2, 1)},
        b.diffuse(0), 5);
  });
  cases.back().scene.shapes.back().emits_on_both_sides = true;
  add("disk", [](SceneBuilder& b) {
    b.shape(DiskDescription{Transform::translate(0.3, 1.8, 0) * Transform::rotate(1, 0.2, 0, 80) * Transform::scale(0.3, 0.3, 1)},
            b.diffuse(0), 5);
  });
  add("sphere", [](SceneBuilder& b) { b.shape(SphereDescription{{-0.2f, 1.6f, 0.2f}, 0.2f}, b.diffuse(0), 5); });
  add("triangles", [](SceneBuilder& b) {
    b.shape(cube(Transform::translate(0.1, 1.7, 0) * Transform::rotate(1, 1, 0.3, 50) * Transform::scale(0.2, 0.1, 0.15)),
            b.diffuse(0), 5);
  });
  return cases;
}

// ---------------------------------------------------------------- no light is lost

// Caustic flux on a quarter of the floor, W.
Measurement caustic_flux(const Scene& scene, const ProjectionMap* map, std::uint64_t photons) {
  return testing::replicated([&](std::uint64_t seed) {
    double flux = 0;
    for (const Photon& photon : shoot(scene, caustic(photons, seed), map).photons) {
      if (photon.position.x > 0 && photon.position.z > 0) flux += static_cast<double>(mean(photon.light.flux()));
    }
    return flux;
  });
}

double z_between(const Measurement& a, const Measurement& b) {
  return std::fabs(a.mean - b.mean) / std::sqrt(a.standard_error * a.standard_error + b.standard_error * b.standard_error);
}

double power_of(const Scene& scene) {
  double power = 0;
  for (const double watt : ParticleSource::powers(scene)) power += watt;
  return power;
}

TEST(ProjectionMap, KeepsTheFluxOfCausticsOfEachKindOfEmitter) {
  for (const EmitterCase& c : emitter_cases()) {
    const Scene scene(c.scene, 1);
    const ProjectionMap mask = caustic_projection(scene), measured = measured_projection(scene);
    const Measurement all = caustic_flux(scene, nullptr, 80000), masked = caustic_flux(scene, &mask, 20000),
                      guided = caustic_flux(scene, &measured, 20000);
    if (c.too_large) {
      EXPECT_EQ(all.mean + masked.mean + guided.mean, 0) << c.name;
      continue;
    }
    EXPECT_LT(z_between(all, masked), kMaxZ) << c.name << ": " << masked.mean << " for " << all.mean;
    EXPECT_LT(z_between(all, guided), kMaxZ) << c.name << ": " << guided.mean << " for " << all.mean;
    // A quarter of the photons, so that the noise would be twice as large.
    EXPECT_LT(masked.standard_error, 2 * all.standard_error) << c.name;
    EXPECT_LT(guided.standard_error, 2 * all.standard_error) << c.name;
    const double power = power_of(scene), unscaled = power / (power - mask.left_out());
    const Measurement twin{masked.mean * unscaled, masked.standard_error * unscaled};
    EXPECT_GT(z_between(all, twin), kTwinZ) << c.name;
  }
}

TEST(ProjectionMap, P1_LedgerSaysWhatIsLeftOut) {
  for (const EmitterCase& c : emitter_cases()) {
    const Scene scene(c.scene, 1);
    const ProjectionMap map = measured_projection(scene);
    const double power = power_of(scene);
    std::vector<double> whole, emitted;
    for (std::uint64_t seed = 1; seed <= kReplicates; ++seed) {
      const FluxLedger l = shoot(scene, caustic(4096, seed), &map).ledger;
      EXPECT_NEAR((l.absorbed + l.escaped + l.cut + l.ended - l.regained) / l.emitted, 1, 1e-6) << c.name;
      EXPECT_NEAR(l.left_out / map.left_out(), 1, 1e-9) << c.name;
      whole.push_back(l.emitted + l.left_out);
      emitted.push_back(l.emitted);
    }
    const Measurement sum = testing::summarize(whole);
    EXPECT_LT(std::fabs(sum.mean - power), kMaxZ * sum.standard_error + 5e-3 * power)
        << c.name << ": " << sum.mean << " of " << power;
    EXPECT_GT(testing::summarize(emitted).z(power), kTwinZ) << c.name;
  }
}

// ---------------------------------------------------------------- the mask is conservative

bool kept(const ProjectionMap& map, std::size_t emitter, Vec2f point, Vec2f direction) {
  const auto in = [](const UnitBox& box, Vec2f u) {
    return u.x >= box.lower.x && u.x < box.upper.x && u.y >= box.lower.y && u.y < box.upper.y;
  };
  return std::any_of(map.cells().begin(), map.cells().end(), [&](const KeptCell& c) {
    return c.emitter == emitter && in(c.cell.point, point) && in(c.cell.direction, direction);
  });
}

// Of evenly chosen rays that meet glass or a mirror first, how many the map masks.
struct Masked {
  int met = 0, masked = 0;
};

Masked masked_rays(const Scene& scene, const ProjectionMap& map) {
  std::mt19937 generator(5);
  const auto number = [&] { return static_cast<float>(generator() >> 8) * 0x1p-24f; };
  RayQueries queries(scene.accelerator());
  Masked result;
  const std::size_t emitters = ParticleSource::powers(scene).size();
  for (int i = 0; i < 300000; ++i) {
    const std::size_t emitter = generator() % emitters;
    const Vec2f point{number(), number()}, direction{number(), number()};
    const auto emission = ParticleSource::emit_from(scene, emitter, point, direction);
    if (!emission) continue;
    Hit hit;
    queries.intersect({&emission->ray, 1}, {&hit, 1}, false);
    if (hit.shape == Hit::kNone || !scene.surface(hit.shape).glossy) continue;
    ++result.met;
    result.masked += !kept(map, emitter, point, direction);
  }
  return result;
}

TEST(ProjectionMap, MasksNoRayThatMeetsWhatItIsFor) {
  for (const EmitterCase& c : emitter_cases()) {
    const Scene scene(c.scene, 1);
    std::vector<Ball> balls = bounding_balls(scene, glossy_shapes(scene));
    const Masked right = masked_rays(scene, {scene, balls});
    EXPECT_GT(right.met, 500) << c.name;
    EXPECT_EQ(right.masked, 0) << c.name << ": of " << right.met;
    balls.resize(1);  // a quarter of one of the things
    balls.front().radius *= 0.25f;
    EXPECT_GT(masked_rays(scene, {scene, balls}).masked, 0) << c.name;
  }
}

// ---------------------------------------------------------------- photons where they are of use

TEST(ProjectionMap, SunOnASmallBallNeedsAThousandthOfThePhotons) {
  SceneBuilder b;
  const int wall = b.diffuse(0.5f);
  b.floor(0, 5, wall);
  for (const double turn : {0, 90, 180, 270}) {
    b.shape(RectangleDescription{Transform::rotate(0, 1, 0, turn) * Transform::translate(0, 5, -5) * Transform::scale(5, 5, 1)},
            wall);
  }
  b.shape(SphereDescription{{1, 0.5f, -2}, 0.05f}, b.add(DielectricDescription{1.5f}));
  b.emitter(DirectionalEmitterDescription{normalize(Vec3f{0.3f, -1, 0.2f}), Rgb{1}});
  const Scene scene(b.description(), 1);
  const ProjectionMap map = measured_projection(scene);
  constexpr std::uint64_t kPhotons = 256;
  // On half of the floor, whose edge cuts the caustic.
  const auto noise = [&](std::uint64_t photons, const ProjectionMap* projection) {
    const Measurement m = testing::replicated([&](std::uint64_t seed) {
      double flux = 0;
      for (const Photon& photon : shoot(scene, caustic(photons, seed), projection).photons) {
        if (photon.position.x > 1.15f) flux += static_cast<double>(photon.light.flux().g);
      }
      return flux;
    });
    return m.standard_error / m.mean;
  };
  const double with = noise(kPhotons, &map), without = noise(1000 * kPhotons, nullptr);
  EXPECT_LT(with, without);
  EXPECT_GT(with * 2000, without);  // not for want of photons to be noisy
  std::printf("sun: noise %.4f of %d photons, %.4f of %d: %.0f times as many for equal noise\n", with, int(kPhotons), without,
              int(1000 * kPhotons), 1000 * without * without / (with * with));
}

// Fifty and one lamps, equally bright, over a glass ball that a wall hides from all but the last.
SceneDescription fifty_and_one(bool fifty) {
  SceneBuilder b;
  b.floor(0, 20, b.diffuse(0));
  b.shape(SphereDescription{{0, 1, 0}, 0.3f}, b.add(DielectricDescription{1.5f}));
  b.shape(RectangleDescription{Transform::translate(2, 2, 0) * Transform::rotate(0, 1, 0, 90) * Transform::scale(20, 2, 1)},
          b.diffuse(0));
  for (int i = 0; fifty && i < 50; ++i) {
    b.emitter(PointEmitterDescription{{4, 1 + 0.02f * static_cast<float>(i), 0.1f * static_cast<float>(i) - 2.5f}, Rgb{1}});
  }
  b.emitter(PointEmitterDescription{{-1, 3, 0}, Rgb{1}});
  return b.description();
}

// Standard deviation over mean of the flux of the caustic.
double caustic_noise(const Scene& scene, const ProjectionMap* map) {
  double flux = 0, squares = 0;
  for (const Photon& photon : shoot(scene, caustic(100000, 1), map).photons) {
    const auto watt = static_cast<double>(photon.light.flux().g);
    flux += watt;
    squares += watt * watt;
  }
  return std::sqrt(squares) / flux;
}

TEST(ProjectionMap, P9_MeasuredBudgetsKeepTheCausticOfOneLampAmongFifty) {
  const Scene single(fifty_and_one(false), 1), scene(fifty_and_one(true), 1);
  const ProjectionMap single_map = measured_projection(single), mask = caustic_projection(scene),
                      measured = measured_projection(scene);
  const double alone = caustic_noise(single, &single_map);
  EXPECT_LT(caustic_noise(scene, &measured), 1.5 * alone);
  EXPECT_GT(caustic_noise(scene, &mask), 1.5 * alone);  // by power alone: what hides the ball shows in its use only
  EXPECT_GT(caustic_noise(scene, nullptr), 1.5 * alone);
  std::printf("P9: noise over that of the single lamp: none %.2f, mask %.2f, measured %.2f\n",
              caustic_noise(scene, nullptr) / alone, caustic_noise(scene, &mask) / alone, caustic_noise(scene, &measured) / alone);
}

TEST(ProjectionMap, NoPhotonIsMuchStrongerThanByPowerAlone) {
  const Scene scene(fifty_and_one(true), 1);
  const ProjectionMap mask = caustic_projection(scene), measured = measured_projection(scene);
  double sum = 0;
  for (std::size_t i = 0; i < mask.cells().size(); ++i) {
    EXPECT_GE(measured.probability(i) * ProjectionMap::kStrongest, mask.probability(i) * (1 - 1e-9));
    sum += measured.probability(i);
  }
  EXPECT_NEAR(sum, 1, 1e-9);
}

// ---------------------------------------------------------------- few photons: catalogue 4.4

// A lamp before a black wall with a window of 0.4 by 0.4; behind it a white wall, whose light falls on a floor.
SceneDescription keyhole() {
  SceneBuilder b;
  const int black = b.diffuse(0);
  for (const double turn : {0, 90, 180, 270}) {
    b.shape(
        RectangleDescription{Transform::rotate(0, 0, 1, turn) * Transform::translate(-0.6, 0.8, 0) * Transform::scale(0.8, 0.6, 1)},
        black);
  }
  b.shape(RectangleDescription{Transform::translate(0, 0, -1)}, b.diffuse(0.8f));
  b.floor(-1, 1, black);
  return b.emitter(PointEmitterDescription{{0, 0, 1}, Rgb{1}}).description();
}

struct FewPhotons {
  double photons = 0, flux = 0, deviation = 0;  // means over seeds, and the standard deviation over the mean of the flux
};

// Of a disk on the floor.
FewPhotons few_photons(const Scene& scene, const ProjectionMap* map, int seeds) {
  FewPhotons few;
  double squares = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const PhotonSettings settings{
        .photons = 20000, .seed = static_cast<std::uint64_t>(seed), .max_bounces = 2, .kinds = PhotonKind::kIndirect};
    double flux = 0;
    for (const Photon& photon : shoot(scene, settings, map).photons) {
      if (length(photon.position - Vec3f{0, -1, -0.5f}) > 0.45f) continue;
      flux += static_cast<double>(photon.light.flux().g);
      few.photons += 1.0 / seeds;
    }
    few.flux += flux / seeds;
    squares += flux * flux / seeds;
  }
  few.deviation = std::sqrt((squares / (few.flux * few.flux) - 1) * seeds / (seeds - 1));
  return few;
}

TEST(ProjectionMap, Fails44_FewPhotonsComeThroughAKeyhole) {
  constexpr int kSeeds = 200;
  const double error = 1 / std::sqrt(2.0 * (kSeeds - 1));  // of a standard deviation, relative
  const Scene scene(keyhole(), 1);
  const FewPhotons few = few_photons(scene, nullptr, kSeeds);
  EXPECT_LT(few.photons, 30);
  EXPECT_NEAR(few.deviation * std::sqrt(few.photons), 1, kMaxZ * error) << few.photons;
  EXPECT_GT(few.deviation * std::sqrt(2 * few.photons), 1 + kTwinZ * error);  // as if there were twice as many
  // Photons for the window alone.
  const ProjectionMap window(scene, {Ball{{0, 0, 0}, 0.3f}});
  const FewPhotons many = few_photons(scene, &window, kSeeds);
  EXPECT_GT(many.photons, 10 * few.photons);
  EXPECT_LT(many.deviation, (1 + kMaxZ * error) / std::sqrt(many.photons));
  const double noise = few.deviation * few.flux / std::sqrt(kSeeds);
  EXPECT_LT(std::fabs(many.flux - few.flux), kMaxZ * noise) << many.flux << " for " << few.flux;
  std::printf("keyhole: %.1f photons, standard deviation %.3f; through its projection map %.1f, %.3f\n", few.photons, few.deviation,
              many.photons, many.deviation);
}

// ---------------------------------------------------------------- bounds of surfaces, and what makes no sense

TEST(ProjectionMap, CoversAPaneClosely) {
  SceneBuilder b;
  b.floor(0, 5, b.add(DielectricDescription{1.5f}));
  const Scene scene(b.description(), 1);
  const std::vector<Ball> balls = bounding_balls(scene, glossy_shapes(scene));
  std::mt19937 generator(3);
  std::uniform_real_distribution<float> place(-5, 5);
  for (int i = 0; i < 10000; ++i) {
    const Vec3f p{place(generator), 0, place(generator)};
    EXPECT_TRUE(std::any_of(balls.begin(), balls.end(), [&](const Ball& ball) { return length(p - ball.center) <= ball.radius; }));
  }
  for (const Ball& ball : balls) EXPECT_LT(ball.radius, 0.9f);  // of a pane 10 wide
}

TEST(ProjectionMap, SaysThatNothingCanShineThere) {
  SceneBuilder b;
  b.floor(0, 1, b.diffuse(0.5f));
  b.shape(SphereDescription{{0, 2, 0}, 0.3f}, b.add(DielectricDescription{1.5f}));
  b.emitter(SpotEmitterDescription{{0, 1, 0}, {0, -1, 0}, Rgb{1}, 40, 40});  // away from the glass
  const Scene scene(b.description(), 1);
  const ProjectionMap map = measured_projection(scene);
  EXPECT_TRUE(map.empty());
  EXPECT_NEAR(map.left_out() / power_of(scene), 1, 1e-9);
  EXPECT_THROW(PhotonTracer(scene, caustic(1, 1), map), SettingError);
}

TEST(ProjectionMap, PhotonsDoNotDependOnThreads) {
  const Scene scene(emitter_cases().front().scene, 1);
  const ProjectionMap map = measured_projection(scene), again = measured_projection(scene);
  const PhotonSettings settings = caustic(3 * kPhotonBatch + 77, 3);
  const ShotPhotons one = shoot(scene, settings, &map, 1), three = shoot(scene, settings, &again, 3);
  ASSERT_EQ(one.photons.size(), three.photons.size());
  for (std::size_t i = 0; i < one.photons.size(); ++i) {
    EXPECT_EQ(one.photons[i].position, three.photons[i].position);
    EXPECT_EQ(one.photons[i].light.flux(), three.photons[i].light.flux());
  }
  EXPECT_EQ(one.ledger.emitted, three.ledger.emitted);
}

}  // namespace
}  // namespace fluxfarm
