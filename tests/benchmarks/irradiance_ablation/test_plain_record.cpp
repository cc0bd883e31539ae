// Where records of each method are used, and what caches of them say.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "ablation_cache.h"

namespace fluxfarm::ablation {
namespace {

constexpr float kSceneRadius = 100;

// On a floor at y = 0 (world), seen from above; irradiance is x + 1.
KnownPlace on_floor(float x, float z) {
  KnownPlace known;
  known.place.position = {x, 0, z};
  known.place.frame = Frame({0, 1, 0});
  known.pixel_m = 0.1f;
  known.irradiance = 1 + x;
  known.by_half = {1 + x, 1 + x};
  const Vec3f gradient = known.place.frame.to_local({1, 0, 0});
  known.cell_gradient = known.occlusion_gradient = {gradient.x, gradient.y};
  known.turned_x = known.turned_y = 0;
  known.harmonic_mean_m = 2;
  known.occlusion_hessian = {0.5, 0, 2};
  return known;
}

GatherPlace floor_place(float x, float z) { return on_floor(x, z).place; }

Method method(Radius radius, Gradient gradient) { return {"", radius, gradient}; }

// How far along a direction of the world a record is used, m.
float reach(const PlainRecord& record, Vec3f direction) {
  float near = 0, far = 50;
  for (int i = 0; i < 40; ++i) {
    const float middle = (near + far) / 2;
    GatherPlace place = floor_place(0, 0);
    place.position = direction * middle;
    (record.weight(place) > 0 ? near : far) = middle;
  }
  return near;
}

TEST(PlainRecord, OfAPureSplitSphereReachesToToleranceTimesTheRadius) {
  const KnownPlace known = on_floor(0, 0);
  const PlainRecord record(known, method(Radius::kPureSplitSphere, Gradient::kNone), {0.3f, 0}, kSceneRadius);
  EXPECT_NEAR(reach(record, {1, 0, 0}), 0.6f, 1e-4f);
  EXPECT_NEAR(reach(record, {0, 0, 1}), 0.6f, 1e-4f);
}

TEST(PlainRecord, OfABoundedSplitSphereKeepsItsBounds) {
  KnownPlace known = on_floor(0, 0);
  const Method bounded = method(Radius::kBoundedSplitSphere, Gradient::kCells);
  // The gradient would leave nothing at 1 m, before the 2 m of the radius.
  EXPECT_NEAR(reach({known, bounded, {0.3f, 100}, kSceneRadius}, {1, 0, 0}), 0.3f, 1e-4f);
  EXPECT_NEAR(reach({known, bounded, {0.3f, 2}, kSceneRadius}, {1, 0, 0}), 0.2f, 1e-4f);
  EXPECT_NEAR(reach({known, bounded, {0.001f, 100}, kSceneRadius}, {1, 0, 0}), 0.05f, 1e-4f);
}

TEST(PlainRecord, OfASplitSphereIsNotUsedBehindItNorTurnedTooFar) {
  const KnownPlace known = on_floor(0, 0);
  const PlainRecord record(known, method(Radius::kPureSplitSphere, Gradient::kNone), {0.3f, 0}, kSceneRadius);
  GatherPlace place = floor_place(0.1f, 0);
  EXPECT_GT(record.weight(place), 0);
  place.position.y = -0.1f;
  EXPECT_EQ(record.weight(place), 0);
  place = floor_place(0.1f, 0);
  place.frame = Frame(normalize({0.5f, 1, 0}));
  EXPECT_EQ(record.weight(place), 0);
}

// The error |H| d^2 / 2 over an ellipse with semi-axes a and b is pi / 8 (h1 a^3 b + h2 a b^3) in all; each axis alone is that of
// the circle with that eigenvalue: pi / 4 h R^4.
TEST(PlainRecord, OfAHessianHasTheToleratedErrorOverItsCircle) {
  KnownPlace known = on_floor(0, 0);
  known.occlusion_hessian = {2, 0, 2};
  constexpr float kTolerance = 0.05f;
  const PlainRecord record(known, method(Radius::kOcclusion, Gradient::kOcclusion), {kTolerance, 0}, kSceneRadius);
  const double radius = static_cast<double>(reach(record, {1, 0, 0}));
  double error = 0;  // over rings of the circle
  constexpr int kRings = 1000;
  for (int i = 0; i < kRings; ++i) {
    const double r = radius * (i + 0.5) / kRings;
    error += 0.5 * 2 * r * r * 2 * M_PI * r * radius / kRings;
  }
  EXPECT_NEAR(error, static_cast<double>(kTolerance) * 1.0, 1e-3 * error);
}

TEST(PlainRecord, OfAHessianAtTheRimHasTheToleratedErrorThere) {
  KnownPlace known = on_floor(0, 0);
  known.occlusion_hessian = {2, 0, 2};
  const PlainRecord record(known, method(Radius::kOcclusionRim, Gradient::kOcclusion), {0.05f, 0}, kSceneRadius);
  const float radius = reach(record, {0, 0, 1});
  EXPECT_NEAR(0.5f * 2 * radius * radius, 0.05f, 1e-4f);
}

TEST(PlainRecord, OfAHessianIsLongWhereTheHessianIsSmall) {
  const KnownPlace known = on_floor(0, 0);
  const Frame& frame = known.place.frame;
  const PlainRecord record(known, method(Radius::kOcclusion, Gradient::kOcclusion), {0.05f, 0}, kSceneRadius);
  EXPECT_NEAR(reach(record, frame.s) / reach(record, frame.t), std::pow(4.0f, 0.25f), 1e-3f);
}

struct Floor {
  std::vector<KnownPlace> places;
  Halves reference;
  AblationCaches::Order order;
};
Floor floor_of(int side) {
  Floor floor;
  for (int i = 0; i < side * side; ++i) {
    floor.places.push_back(on_floor(0.1f * static_cast<float>(i % side), 0.1f * static_cast<float>(i / side)));
    floor.reference.push_back(floor.places.back().by_half);
  }
  floor.order.resize(floor.places.size());
  std::iota(floor.order.begin(), floor.order.end(), std::size_t{0});
  return floor;
}

TEST(AblationCaches, WithGradientsAreExactInLinearLightAndWithoutAreNot) {
  const Floor floor = floor_of(30);
  const AblationCaches caches(floor.places, floor.reference, {floor.order}, kSceneRadius);
  const auto with = caches.of_size(method(Radius::kPureSplitSphere, Gradient::kCells), 0, 20);
  const auto without = caches.of_size(method(Radius::kPureSplitSphere, Gradient::kNone), 0, 20);
  ASSERT_TRUE(with && without);
  EXPECT_NEAR(with->records, without->records, 0.5);
  EXPECT_NEAR(with->records, 20, 2);
  EXPECT_LT(with->error.rms, 1e-5);
  EXPECT_GT(without->error.rms, 0.02);
}

TEST(AblationCaches, DoNotHaveASizeThatTheirBoundsForbid) {
  const Floor floor = floor_of(30);
  const AblationCaches caches(floor.places, floor.reference, {floor.order}, kSceneRadius);
  EXPECT_FALSE(caches.of_size(method(Radius::kBoundedSplitSphere, Gradient::kCells), 2, 5));
}

TEST(CacheError, LeavesOutTheNoiseOfTheReferenceAndTellsThatOfRecords) {
  // Truth 1, found 1.3; halves of the reference are 0.2 off, each to a side of its own.
  Halves reference;
  Found found;
  for (int i = 0; i < 400; ++i) {
    reference.push_back({i % 2 == 0 ? 1.2f : 0.8f, i / 2 % 2 == 0 ? 1.2f : 0.8f});
    found.push_back(PlainRecord::Told{1.3f, {1.5f, 1.1f}});
  }
  const CacheError error = error_of(found, reference);
  EXPECT_NEAR(error.rms, 0.3, 1e-5);
  EXPECT_NEAR(error.noise, 0.2, 1e-5);
  EXPECT_NEAR(error.largest, 0.5, 1e-5);
}

TEST(CacheError, OfWhatIsNotFoundIsNone) {
  const CacheError error = error_of({std::nullopt, PlainRecord::Told{2, {2, 2}}}, {{1, 1}, {1, 1}});
  EXPECT_NEAR(error.rms, std::sqrt(0.5), 1e-6);
}

}  // namespace
}  // namespace fluxfarm::ablation
