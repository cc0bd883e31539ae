// Where disks of photons reach over edges, walls and folds: rows of catalogue 4.4, unguarded as predicted, guarded right. Each
// case has a twin, which the same test rejects.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "integrators/photon/density_estimate.h"
#include "integrators/photon/density_kernel.h"
#include "integrators/photon/disk_in_sight.h"
#include "integrators/photon/one_of_photons.h"
#include "integrators/photon_scenes.h"

namespace fluxfarm {
namespace {

using testing::kMaxZ;
using testing::kTwinZ;
using testing::Measurement;
using testing::SceneBuilder;
using testing::shoot;

constexpr float kRadius = 0.2f;  // of estimates, m
constexpr int kDraws = 16;       // of the inverse of a part, to keep its noise low
constexpr Vec3f kUp{0, 1, 0};

// Part of a disk of radius one beyond a chord at distance x from its middle.
double beyond_chord(double x) { return (std::acos(x) - x * std::sqrt(1 - x * x)) / M_PI; }

// Places 0.1 apart along z; of two neighbours half of the photons are the same.
std::vector<Vec3f> along_z(float x, float y = 0) {
  std::vector<Vec3f> places;
  for (int i = -5; i <= 5; ++i) places.push_back({x, y, 0.1f * static_cast<float>(i)});
  return places;
}

// Estimates of irradiance with the box kernel, means over the places.
struct Estimates {
  Measurement untested;   // all photons near by
  Measurement turned;     // of those the ones whose surface is turned as here
  Measurement unguarded;  // those that pass the tests of a patch
  Measurement guarded;    // in sight, over the part of the disk in sight
};

Estimates at(const SceneDescription& description, const std::vector<Vec3f>& places, Vec3f normal = kUp) {
  const Scene scene(description, 1);
  RayQueries queries(scene.accelerator());
  std::array<std::vector<double>, 4> values;
  for (std::uint64_t seed = 1; seed <= testing::kReplicates; ++seed) {
    const PhotonSettings settings{.photons = 30000, .seed = seed, .kinds = PhotonKind::kDirect};
    const PhotonMap map(shoot(scene, settings).photons, 2);
    KeyRandom random(seed, KeyRandom::kLabel, 0);
    std::array<double, 4> sums{};
    for (const Vec3f place : places) {
      const SurfacePatch patch(place, normal, PhotonSide::kFront, kRadius);
      const DiskInSight disk(scene, patch, kRadius, queries);
      double inverse_part = 0;
      for (int i = 0; i < kDraws; ++i) inverse_part += static_cast<double>(disk.inverse_parts(BoxKernel{}, random).wide) / kDraws;
      map.for_each_within(place, kRadius, [&](Vec3f d, const PhotonLight& light) {
        const auto flux = static_cast<double>(light.flux().g);
        sums[0] += flux;
        if (dot(normalize(light.normal()), normal) > 0.9f) sums[1] += flux;
        if (!patch.accepts(d, light)) return;
        sums[2] += flux;
        if (disk.sees(place + d, normalize(light.normal()))) sums[3] += flux * inverse_part;
      });
    }
    const double area = M_PI * static_cast<double>(kRadius) * static_cast<double>(kRadius);
    for (std::size_t i = 0; i < 4; ++i) values[i].push_back(sums[i] / area / static_cast<double>(places.size()));
  }
  return {testing::summarize(values[0]), testing::summarize(values[1]), testing::summarize(values[2]),
          testing::summarize(values[3])};
}

// A guarded estimate is the truth, and would not pass for one that is off by so much.
void expect_truth(const Measurement& m, double truth, double wrong, const char* what) {
  EXPECT_LT(m.z(truth), kMaxZ) << what << ": " << m.mean << " for " << truth << " +- " << m.standard_error;
  EXPECT_GT(m.z(wrong), kTwinZ) << what << ": " << m.mean << " +- " << m.standard_error;
}

// A plate of two by two under the sun, which brings irradiance one.
SceneBuilder plate() {
  SceneBuilder builder;
  builder.floor(0, 1, builder.diffuse(0));
  return builder.emitter(DirectionalEmitterDescription{-kUp, Rgb{1}});
}

TEST(DiskInSight, Fails44_BoundaryBiasAtAFreeEdge) {
  for (const float x : {0.0f, 0.25f, 0.5f, 0.75f}) {
    const Estimates e = at(plate().description(), along_z(0.9999f - x * kRadius));
    const double part = 1 - beyond_chord(static_cast<double>(x));
    expect_truth(e.unguarded, part, 1, "unguarded");
    expect_truth(e.guarded, 1, part, "guarded");
  }
}

TEST(DiskInSight, Fails44_BoundaryBiasAtARightAngledCorner) {
  std::vector<Vec3f> corners;
  for (const float x : {-0.9999f, 0.9999f}) {
    for (const float z : {-0.9999f, 0.9999f}) corners.insert(corners.end(), {Vec3f{x, 0, z}, Vec3f{x, 0, z}, Vec3f{x, 0, z}});
  }
  const Estimates e = at(plate().description(), corners);
  expect_truth(e.unguarded, 0.25, 0.3, "unguarded");
  expect_truth(e.guarded, 1, 0.25, "guarded");
}

TEST(DiskInSight, NothingChangesWhereTheDiskIsAllSurface) {
  const Estimates e = at(plate().description(), along_z(0));
  EXPECT_DOUBLE_EQ(e.guarded.mean, e.unguarded.mean);  // each probe succeeds, each photon is in sight
  SceneBuilder ball;
  ball.shape(SphereDescription{{0, 0, 0}, kRadius / 0.38f}, ball.diffuse(0));  // nearly as curved as the tests of a patch let pass
  ball.emitter(DirectionalEmitterDescription{-kUp, Rgb{1}});
  const Estimates curved = at(ball.description(), {{0, kRadius / 0.38f, 0}});
  EXPECT_NEAR(curved.guarded.mean / curved.unguarded.mean, 1, 0.02);
}

// Means of the two inverse parts over many draws at a place of the scene.
std::array<Measurement, 2> inverse_parts(const SceneDescription& description, Vec3f place) {
  const Scene scene(description, 1);
  RayQueries queries(scene.accelerator());
  const SurfacePatch patch(place, kUp, PhotonSide::kFront, kRadius);
  const DiskInSight disk(scene, patch, kRadius, queries);
  std::array<std::vector<double>, 2> values;
  for (std::uint64_t seed = 1; seed <= 4000; ++seed) {
    KeyRandom random(seed, KeyRandom::kLabel, 0);
    const DiskInSight::InverseParts parts = disk.inverse_parts(BoxKernel{}, random);
    values[0].push_back(static_cast<double>(parts.wide));
    values[1].push_back(static_cast<double>(parts.narrow));
  }
  return {testing::summarize(values[0]), testing::summarize(values[1])};
}

TEST(DiskInSight, KnowsThePartOfTheDiskOfHalfTheArea) {
  for (const double x : {0.0, 0.25, 0.5}) {
    const auto [wide, narrow] = inverse_parts(plate().description(), {0.99999f - static_cast<float>(x) * kRadius, 0, 0.1f});
    expect_truth(wide, 1 / (1 - beyond_chord(x)), 1, "wide");
    expect_truth(narrow, 1 / (1 - beyond_chord(x * std::numbers::sqrt2)), 1, "narrow");
    if (x > 0) {
      EXPECT_GT(narrow.z(wide.mean), kTwinZ) << x;
    }
  }
}

// What stands on the plate takes its place; what lies on it in a point hangs over it, where light is uneven on all sides.
TEST(DiskInSight, TellsABoxFromABall) {
  SceneBuilder box = plate();
  box.shape(testing::cube(Transform::translate(-0.5, 0.1, 0) * Transform::scale(0.5, 0.1, 0.5)), box.diffuse(0));
  expect_truth(inverse_parts(box.description(), {1e-4f, 0, 0})[0], 2, 1, "beside a box");
  SceneBuilder sunk = plate();  // the plate goes on in it
  sunk.shape(testing::cube(Transform::translate(-0.5, 0, 0) * Transform::scale(0.5, 0.2, 0.5)), sunk.diffuse(0));
  expect_truth(inverse_parts(sunk.description(), {1e-4f, 0, 0})[0], 2, 1, "beside a box that is sunk in");
  SceneBuilder ball = plate();
  ball.shape(SphereDescription{{0, 0.3f, 0}, 0.3f}, ball.diffuse(0));
  for (const float x : {0.02f, 0.05f, 0.1f, 0.15f})
    EXPECT_NEAR(inverse_parts(ball.description(), {x, 0, 0})[0].mean, 1, 0.002) << x;
}

// One photon in all stands for each part of them, in the mean and in each channel.
TEST(DiskInSight, OnePhotonStandsForAll) {
  const std::vector<ScatteredPhotons::Part> parts{{Rgb{1, 0, 0}, Rgb{1, 0, 0}, true},
                                                  {Rgb{0, 0, 0}, {}, false},
                                                  {Rgb{1, 2, 4}, {}, false},
                                                  {Rgb{0.1f, 0.1f, 0.1f}, Rgb{0.2f, 0.2f, 0.2f}, false}};
  constexpr int kNumbers = 100000;
  std::array<Rgb, 4> wide, narrow;
  std::array<int, 4> chosen{};
  for (int i = 0; i < kNumbers; ++i) {
    OneOfPhotons one((static_cast<float>(i) + 0.5f) / kNumbers);
    EXPECT_TRUE(one.empty());
    for (std::uint32_t p = 0; p < parts.size(); ++p) one.offer(p, parts[p]);
    wide[one.photon()] += one.stands_for().wide / kNumbers;
    narrow[one.photon()] += one.stands_for().narrow / kNumbers;
    ++chosen[one.photon()];
    EXPECT_EQ(one.stands_for().smooth, parts[one.photon()].smooth);
  }
  for (std::size_t p = 0; p < parts.size(); ++p) {
    EXPECT_NEAR(wide[p].b, parts[p].wide.b, 0.02f * parts[p].wide.b) << p;
    EXPECT_NEAR(narrow[p].r, parts[p].narrow.r, 0.02f * parts[p].narrow.r) << p;
  }
  EXPECT_EQ(chosen[1], 0);
  EXPECT_GT(chosen[2], 10 * chosen[3]);  // not each alike
}

// The sun comes at 45 degrees, over a wall without thickness that stands on the plate along x = 0.
TEST(DiskInSight, Fails44_ThinWallLeak) {
  SceneBuilder builder;
  builder.shape(RectangleDescription{Transform::translate(0.3, 0, 0) * Transform::rotate(1, 0, 0, -90)}, builder.diffuse(0));
  builder.shape(RectangleDescription{Transform::rotate(0, 1, 0, 90) * Transform::scale(1.5, 0.9, 1)}, builder.diffuse(0));
  builder.emitter(DirectionalEmitterDescription{normalize(Vec3f{-1, -1, 0}), Rgb{1}});
  const double lit = std::numbers::sqrt2 / 2;
  for (const float x : {0.05f, 0.25f, 0.5f, 0.75f}) {
    const double leaks = lit * beyond_chord(static_cast<double>(x));
    const Estimates dark = at(builder.description(), along_z(-x * kRadius));
    expect_truth(dark.unguarded, leaks, 0, "unguarded");
    EXPECT_EQ(dark.guarded.mean, 0);
    const Estimates bright = at(builder.description(), along_z(x * kRadius));
    expect_truth(bright.unguarded, lit - leaks, lit, "unguarded");
    expect_truth(bright.guarded, lit, lit - leaks, "guarded");
  }
  EXPECT_EQ(at(builder.description(), along_z(-1.05f * kRadius)).unguarded.mean, 0);
}

// A wall of the light of the floor meets it at x = 0.
TEST(DiskInSight, Fails44_PerpendicularCrease) {
  SceneBuilder builder;
  builder.shape(RectangleDescription{Transform::translate(1, 0, 0) * Transform::rotate(1, 0, 0, -90)}, builder.diffuse(0));
  builder.shape(
      RectangleDescription{Transform::translate(0, 0.7, 0) * Transform::rotate(0, 1, 0, 90) * Transform::scale(1, 0.7, 1)},
      builder.diffuse(0));
  builder.emitter(DirectionalEmitterDescription{normalize(Vec3f{-1, -1, 0}), Rgb{1}});
  const double truth = std::numbers::sqrt2 / 2;
  for (const float x : {0.005f, 0.25f, 0.54f}) {
    const auto d = static_cast<double>(x);
    const double rejected = 1 - beyond_chord(d), accepted = rejected + (1 - d * d) / 2;
    const Estimates e = at(builder.description(), along_z(x * kRadius));
    expect_truth(e.untested, truth * accepted, truth * rejected, "all accepted");
    expect_truth(e.unguarded, truth * rejected, truth, "the wall's rejected");
    expect_truth(e.guarded, truth, truth * rejected, "guarded");
  }
}

// Right-angled ridges of that width along z: their flanks lie at 45 degrees under the sun.
SceneDescription saw_tooth(double period) {
  MeshDescription mesh;
  const int teeth = static_cast<int>(2 / period);
  for (int i = 0; i <= 2 * teeth; ++i) {
    const auto x = static_cast<float>(-1 + i * period / 2), y = static_cast<float>(i % 2 * period / 2);
    mesh.positions.push_back({x, y, -1});
    mesh.positions.push_back({x, y, 1});
  }
  for (std::uint32_t i = 0; i < 4 * static_cast<std::uint32_t>(teeth); i += 2) {
    for (const std::uint32_t corner : {0u, 1u, 3u, 0u, 3u, 2u}) mesh.indices.push_back(i + corner);
  }
  SceneBuilder builder;
  builder.shape(mesh, builder.diffuse(0));
  return builder.emitter(DirectionalEmitterDescription{-kUp, Rgb{1}}).description();
}

TEST(DiskInSight, Fails44_TopologicalBiasOfASawTooth) {
  constexpr double kPeriod = 0.02;
  const double truth = std::numbers::sqrt2 / 2;
  std::vector<Vec3f> places;  // at all heights of flanks that rise with x
  for (int i = 0; i < 20; ++i) {
    const auto up = static_cast<float>((i + 0.5) / 20 * kPeriod / 2);
    places.push_back({(i - 10) * static_cast<float>(kPeriod) + up, up, 0.05f * static_cast<float>(i - 10)});
  }
  const Estimates e = at(saw_tooth(kPeriod), places, normalize(Vec3f{-1, 1, 0}));
  expect_truth(e.untested, truth * std::numbers::sqrt2, truth, "all flanks");
  expect_truth(e.turned, truth / std::numbers::sqrt2, truth, "those that are turned alike");
  EXPECT_LT(e.unguarded.mean, 0.4 * truth);  // near the plane of the one that asks, too
  EXPECT_NEAR(e.guarded.mean, truth, 0.03 * truth + kMaxZ * e.guarded.standard_error);
  EXPECT_GT(e.guarded.z(truth / std::numbers::sqrt2), kTwinZ);
}

// The edge of a shadow is no edge of a surface: only a smaller disk tells.
TEST(DiskInSight, Fails44_ProximityBiasAtTheEdgeOfAShadow) {
  SceneBuilder builder = plate();
  builder.shape(RectangleDescription{Transform::translate(-0.87, 1, 0) * Transform::rotate(1, 0, 0, -90)}, builder.diffuse(0));
  const SceneDescription description = builder.description();  // lit from there on
  constexpr float kEdge = 0.13f;
  for (const float x : {-1.05f, -0.5f, 0.0f, 0.5f, 1.05f}) {
    const double lit = x <= -1 ? 0 : x >= 1 ? 1 : 1 - beyond_chord(static_cast<double>(x)), truth = x < 0 ? 0 : 1;
    const Estimates e = at(description, along_z(kEdge + x * kRadius));
    EXPECT_LT(e.unguarded.z(lit), kMaxZ) << x;
    EXPECT_EQ(e.guarded.mean, e.unguarded.mean);  // no help here
    if (x == 0.5f || x == -0.5f) {
      EXPECT_GT(e.unguarded.z(truth), kTwinZ) << x;
    }
  }
  const Scene scene(description, 1);
  for (const float x : {-0.5f, 0.5f}) {
    const Measurement m = testing::replicated([&](std::uint64_t seed) {
      const PhotonMap map(shoot(scene, {.photons = 30000, .seed = seed}).photons, 2);
      const SurfacePatch patch({kEdge + x * kRadius, 0, 0}, kUp, PhotonSide::kFront, 0.4f * kRadius);
      return static_cast<double>(estimate_within(map, patch, 0.4f * kRadius, BoxKernel{}).value.g);
    });
    const double truth = x < 0 ? 0 : 1;
    EXPECT_LE(std::fabs(m.mean - truth), kMaxZ * m.standard_error) << x << ": " << m.mean;
  }
}

}  // namespace
}  // namespace fluxfarm
