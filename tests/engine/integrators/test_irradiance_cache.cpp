// Records of irradiance and the cache that holds them.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "integrators/irradiance/cache_quality.h"
#include "integrators/irradiance/irradiance_cache.h"
#include "integrators/irradiance/neighbour_check.h"

namespace fluxfarm {
namespace {

HemisphereIrradiance even_light(float irradiance) {
  HemisphereIrradiance light;
  light.irradiance = Rgb{irradiance};
  light.by_replicate.fill(Rgb{irradiance});
  return light;
}

constexpr RecordLimits kLimits{.tolerance = 0.1f, .least_irradiance = 1e-3f, .max_radius = 2};
const Frame kFrame{normalize(Vec3f{0.3f, -0.4f, 0.8f})};
constexpr Vec3f kPlace{1, 2, 3};

TEST(IrradianceRecord, ReachesAsFarAsItsHessianAllows) {
  HemisphereIrradiance light = even_light(2);
  light.hessian = {4, 0, -0.25};
  RecordLimits limits = kLimits;
  limits.max_radius = 100;
  const IrradianceRecord record(kPlace, kFrame, 9, light, limits);
  // Half of 4 r^2 is a tenth of 2, and the same for 0.25.
  EXPECT_NEAR(record.smaller_radius(), std::sqrt(0.1f), 1e-3f);
  EXPECT_NEAR(record.larger_radius(), std::sqrt(1.6f), 1e-3f);
  const auto weight = [&](float x, float y) { return record.use_at(kPlace + kFrame.to_world({x, y, 0}), kFrame.n, 4).weight; };
  EXPECT_NEAR(weight(0, 0), 1, 1e-6f);
  EXPECT_GT(weight(0.31f, 0), 0);
  EXPECT_EQ(weight(0.32f, 0), 0);
  EXPECT_GT(weight(0, 1.25f), 0);
  EXPECT_EQ(weight(0, 1.28f), 0);
  // Its error at the rim is the tolerance.
  EXPECT_NEAR(record.use_at(kPlace + kFrame.to_world({0.31f, 0, 0}), kFrame.n, 4).error, 0.2f, 0.01f);
  EXPECT_NEAR(record.use_at(kPlace + kFrame.to_world({0, 1.25f, 0}), kFrame.n, 4).error, 0.2f, 0.01f);
}

TEST(IrradianceRecord, IsBoundedByWhatIsNearAndByItsGradient) {
  RecordLimits limits = kLimits;
  limits.max_radius = 5;
  HemisphereIrradiance light = even_light(2);
  EXPECT_NEAR(IrradianceRecord(kPlace, kFrame, 9, light, limits).larger_radius(), 5, 1e-2f);
  // A wall at 0.3: a tenth of the irradiance may change at its distance, which is the tolerance.
  light.clearance = {1 / 0.09, 0, 1};
  const IrradianceRecord beside_wall(kPlace, kFrame, 9, light, limits);
  EXPECT_NEAR(beside_wall.smaller_radius(), 0.3f, 0.01f);
  EXPECT_NEAR(beside_wall.larger_radius(), 1, 0.03f);
  light.near_irradiance = 16;  // a bright one
  EXPECT_NEAR(IrradianceRecord(kPlace, kFrame, 9, light, limits).smaller_radius(), 0.15f, 0.01f);
  light = even_light(2);
  light.gradient_x = Rgb{3};
  light.gradient_y = Rgb{-4};
  const IrradianceRecord steep(kPlace, kFrame, 9, light, limits);
  EXPECT_NEAR(steep.smaller_radius(), 0.4f, 0.01f);
  EXPECT_NEAR(steep.larger_radius(), 5, 0.05f);
}

// What is near may hide what shines.
TEST(IrradianceRecord, IsBoundedByWhatIsNearInTheDark) {
  HemisphereIrradiance light = even_light(0);
  light.clearance = {1 / 0.09, 0, 1 / 0.09};
  EXPECT_NEAR(IrradianceRecord(kPlace, kFrame, 9, light, kLimits).larger_radius(), 0.3f, 0.01f);
}

TEST(IrradianceRecord, GoesOnWithItsGradients) {
  HemisphereIrradiance light = even_light(2);
  light.gradient_x = Rgb{1, 0, 0};
  light.gradient_y = Rgb{0, 0.5f, 0};
  light.turned_x = Rgb{0, 0, 0.5f};
  light.gradient_noise = 0.3f;
  const IrradianceRecord record(kPlace, kFrame, 9, light, kLimits);
  const Vec3f normal = kFrame.to_world(normalize(Vec3f{0.2f, 0, 1}));
  const IrradianceRecord::Use use = record.use_at(kPlace + kFrame.to_world({0.1f, 0.2f, 0}), normal, 4);
  const float cosine = 1 / std::sqrt(1.04f);
  EXPECT_NEAR(use.irradiance.r, 2 * cosine + 0.1f, 2e-3f);
  EXPECT_NEAR(use.irradiance.g, 2 * cosine + 0.1f, 2e-3f);
  EXPECT_NEAR(use.irradiance.b, 2 * cosine + 0.1f * cosine, 2e-3f);
  EXPECT_NEAR(use.error, 0.3f * std::sqrt(0.05f), 2e-3f);
  EXPECT_EQ(record.use_at(kPlace, -kFrame.n, 4).weight, 0);
  EXPECT_EQ(record.use_at(kPlace + kFrame.to_world({0, 0, 0.6f}), kFrame.n, 4).weight, 0);  // on another surface above it
}

TEST(IrradianceRecord, IsUsedOnItsOwnSurfaceAlone) {
  RecordLimits limits = kLimits;
  limits.max_radius = 0.5f;
  const IrradianceRecord record(kPlace, kFrame, 9, even_light(2), limits);
  const auto weight = [&](Vec3f place, Vec3f normal) {
    return record.use_at(kPlace + kFrame.to_world(place), kFrame.to_world(normalize(normal)), 4).weight;
  };
  EXPECT_GT(weight({0.2f, 0, 0}, {0, 0, 1}), 0.5f);
  EXPECT_EQ(weight({0.2f, 0, 0.05f}, {0, 0, 1}), 0);  // a step up
  EXPECT_EQ(weight({0.2f, 0, -0.05f}, {0, 0, 1}), 0);
  EXPECT_GT(weight({0.2f, 0, -0.02f}, {0.2f, 0, 1}), 0.4f);  // a bend: z = -x^2 / 2
  EXPECT_GT(weight({0.2f, 0, 0}, {0.2f, 0, 1}), 0.4f);       // normals of a bump map
  EXPECT_EQ(weight({0.2f, 0, 0.05f}, {0.2f, 0, 1}), 0);      // bent the other way
}

TEST(IrradianceRecord, BringsTheNoiseOfItsReplicates) {
  HemisphereIrradiance light = even_light(2);
  light.by_replicate[3] = Rgb{1, 2, 4};
  const IrradianceCache cache({IrradianceRecord(kPlace, kFrame, 9, light, kLimits)}, 0.5f);
  const auto third = cache.interpolate({kPlace, kFrame.n, 9}, 3), other = cache.interpolate({kPlace, kFrame.n, 9}, 2);
  ASSERT_TRUE(third && other);
  EXPECT_NEAR(third->irradiance.r, 1, 0.04f);
  EXPECT_NEAR(third->irradiance.b, 4, 0.04f);
  EXPECT_NEAR(other->irradiance.b, 2, 0.02f);
  EXPECT_FALSE(cache.interpolate({kPlace, kFrame.n, 8}, 3));  // light that met fewer surfaces
}

// ---------------------------------------------------------------- neighbours

KeptRecord kept(Vec3f place, HemisphereIrradiance light) {
  GatherPlace at;
  at.position = kPlace + kFrame.to_world(place);
  at.frame = kFrame;
  at.room = 9;
  return {at, light};
}

TEST(NeighbourCheck, KeepsARecordFromWhereItIsWrong) {
  const auto checked = [](const HemisphereIrradiance& light, const HemisphereIrradiance& other) {
    KeptRecord record = kept({}, light);
    const IrradianceRecord before(record.place.position, record.place.frame, 9, record.light, kLimits);
    check_by_neighbour(record, before, kept({0.5f, 0, 0}, other), 0.5f);
    return IrradianceRecord(record.place.position, record.place.frame, 9, record.light, kLimits);
  };
  const IrradianceRecord wrong = checked(even_light(2), even_light(1));
  const auto error = [&](float x, float y) { return wrong.use_at(kPlace + kFrame.to_world({x, y, 0}), kFrame.n, 4).error; };
  EXPECT_NEAR(wrong.extrapolate(kPlace + kFrame.to_world({0.5f, 0, 0}), kFrame.n).error, 1, 0.02f);
  EXPECT_NEAR(wrong.smaller_radius(), 0.5f * std::cbrt(0.2f), 0.01f);  // where its cube is the tolerance, 0.2
  EXPECT_NEAR(error(wrong.smaller_radius() * 0.99f, 0), 0.2f, 0.02f);
  EXPECT_LT(error(0, 0.5f), 1e-6f);  // of what lies to the side it has not heard
  EXPECT_NEAR(wrong.larger_radius(), kLimits.max_radius, 0.01f);
  // Right, or as far as noise can tell.
  EXPECT_NEAR(checked(even_light(2), even_light(2)).smaller_radius(), kLimits.max_radius, 0.01f);
  HemisphereIrradiance noisy = even_light(1);
  for (std::size_t i = 0; i < kReplicates; ++i) noisy.by_replicate[i] = Rgb{i % 2 == 0 ? 0.0f : 2.0f};
  EXPECT_NEAR(noisy.noise(), 1 / std::sqrt(7.0f), 1e-3f);
  EXPECT_GT(checked(even_light(1.7f), noisy).smaller_radius(), 1.9f);
  EXPECT_LT(checked(even_light(2), noisy).smaller_radius(), 1);
  // Twin: a gradient that foresees it.
  HemisphereIrradiance steep = even_light(2);
  steep.gradient_x = Rgb{-2};
  EXPECT_NEAR(checked(steep, even_light(1)).larger_radius(), kLimits.max_radius, 0.01f);
}

// ---------------------------------------------------------------- cache

std::vector<IrradianceRecord> many_records(std::size_t count, std::mt19937& random) {
  std::uniform_real_distribution<float> unit(-1, 1);
  std::vector<IrradianceRecord> records;
  for (std::size_t i = 0; i < count; ++i) {
    HemisphereIrradiance light = even_light(2 + unit(random));
    light.hessian = {std::exp(static_cast<double>(4 * unit(random) + 3)), 0, std::exp(static_cast<double>(4 * unit(random) + 3))};
    const Frame frame(normalize(Vec3f{0.2f * unit(random), 0.2f * unit(random), 1}));
    records.emplace_back(Vec3f{3 * unit(random), 3 * unit(random), 0}, frame, 9, light, kLimits);
  }
  return records;
}

TEST(IrradianceCache, FindsAllRecordsThatReachAPlace) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-1, 1);
  const std::vector<IrradianceRecord> records = many_records(2000, random);
  constexpr float kMaxAngle = 0.5f;
  const IrradianceCache cache(records, kMaxAngle);
  EXPECT_EQ(cache.records().size(), records.size());
  int covered = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const ReceivingPlace place{{4 * unit(random), 4 * unit(random), 0.01f * unit(random)}, {0, 0, 1}, 9};
    float weight = 0, sum = 0;
    for (const IrradianceRecord& record : records) {
      const IrradianceRecord::Use use = record.use_at(place.position, place.normal, 1 / (kMaxAngle * kMaxAngle));
      weight += use.weight;
      sum += use.weight * use.irradiance.g;
    }
    const auto found = cache.interpolate(place, 0);
    EXPECT_EQ(cache.covers(place), found.has_value());
    if (std::fabs(weight - 0.05f) < 1e-3f) continue;
    ASSERT_EQ(found.has_value(), weight >= 0.05f) << weight;
    if (!found) continue;
    ++covered;
    EXPECT_NEAR(found->irradiance.g, sum / weight, 0.02f * sum / weight);  // shares of replicates have 8 bits
  }
  EXPECT_GT(covered, 500);
  EXPECT_LT(covered, 2000);
}

TEST(IrradianceCache, TakesLessThan128BytesARecord) {
  std::mt19937 random(5);
  const IrradianceCache cache(many_records(10000, random), 0.5f);
  EXPECT_LT(cache.bytes(), 128u * 10000);
}

TEST(IrradianceCache, WithoutRecordsKnowsNothing) {
  EXPECT_FALSE(IrradianceCache().interpolate({kPlace, kFrame.n, 9}, 0));
  EXPECT_FALSE(IrradianceCache({}, 0.5f).covers({kPlace, kFrame.n, 9}));
}

// ---------------------------------------------------------------- quality

TEST(CacheQuality, LevelsCutTheSamplesWithoutGaps) {
  std::uint32_t next = 0;
  float tolerance = 1;
  int strata = 0;
  while (next < 50000) {
    const SampleRange level = cache_level({next, next + 1});
    EXPECT_EQ(level.begin, next);
    EXPECT_EQ(cache_level({level.end - 1, level.end}), level);
    const CacheQuality quality = quality_of(level);
    EXPECT_LT(quality.tolerance, tolerance);
    EXPECT_GT(quality.strata, strata);
    EXPECT_EQ(quality.strata % static_cast<int>(kReplicates), 0);
    tolerance = quality.tolerance;
    strata = quality.strata;
    next = level.end;
  }
}

}  // namespace
}  // namespace fluxfarm
