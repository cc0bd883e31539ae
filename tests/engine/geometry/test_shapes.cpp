// Shapes as lights: the samples follow the density that pdf() states, and the density integrates to one over what is seen.
#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "accel/ray_accelerator.h"
#include "geometry/disk.h"
#include "geometry/rectangle.h"
#include "geometry/sphere.h"
#include "geometry/spherical_rectangle.h"
#include "geometry/spherical_triangle.h"
#include "geometry/triangle_mesh.h"
#include "support/chi_square.h"

namespace fluxfarm::testing {
namespace {

struct LightCase {
  std::string name;
  std::unique_ptr<Shape> shape;
  Vec3f reference;
};

std::vector<LightCase> cases() {
  std::vector<LightCase> result;
  const auto add = [&](const char* name, std::unique_ptr<Shape> shape, Vec3f reference) {
    result.push_back({name, std::move(shape), reference});
  };
  add("sphere outside", std::make_unique<Sphere>(Vec3f{0, 0, 3}, 1.0f, false), {0.2f, 0.1f, 0});
  add("sphere close", std::make_unique<Sphere>(Vec3f{0, 0, 1.2f}, 1.0f, false), {0, 0, 0});
  add("sphere inside", std::make_unique<Sphere>(Vec3f{0, 0, 0}, 2.0f, true), {0.5f, -0.4f, 0.9f});
  add("disk", std::make_unique<Disk>(Vec3f{0.3f, 0, 1}, Vec3f{0, 0, -1}, Vec3f{1, 0, 0}, 0.8f), Vec3f{0, 0, 0});
  add("rectangle near", std::make_unique<Rectangle>(Vec3f{-0.4f, -1, 0.5f}, Vec3f{1, 0, 0}, Vec3f{0, 2, 0}, true), Vec3f{0, 0, 0});
  add("rectangle far", std::make_unique<Rectangle>(Vec3f{-0.4f, -1, 3}, Vec3f{1, 0, 0}, Vec3f{0, 2, 0}, true), Vec3f{0, 0, 0});
  add("parallelogram", std::make_unique<Rectangle>(Vec3f{-0.4f, -1, 1}, Vec3f{1, 0, 0.2f}, Vec3f{0.7f, 2, 0}, true),
      Vec3f{0, 0, 0});
  TriangleMesh::Data far_mesh{{{-1, -1, 6}, {1, -1, 6.3f}, {0, 1, 5.8f}, {1.5f, 1, 6}}, {}, {}, {0, 2, 1, 1, 2, 3}, {}};
  add("mesh far", std::make_unique<TriangleMesh>(far_mesh, false, true), Vec3f{0, 0, 0});
  TriangleMesh::Data mesh{{{-1, -1, 1}, {1, -1, 1.3f}, {0, 1, 0.8f}, {1.5f, 1, 1}}, {}, {}, {0, 2, 1, 1, 2, 3}, {}};
  add("mesh", std::make_unique<TriangleMesh>(mesh, false, true), Vec3f{0, 0, 0});
  return result;
}

// Every sample lies on the shape as the density says: wi and distance lead to the position, and pdf() agrees with sample().
TEST(ShapeAsLight, SampleAndPdfTellTheSameDensity) {
  for (const LightCase& c : cases()) {
    std::mt19937 generator(1);
    std::uniform_real_distribution<float> uniform(0, 0.99999f);
    for (int i = 0; i < 2000; ++i) {
      const auto s = c.shape->sample(c.reference, {uniform(generator), uniform(generator)});
      ASSERT_TRUE(s.has_value()) << c.name;
      EXPECT_NEAR(length(c.reference + s->distance * s->wi - s->position), 0, 1e-4f) << c.name;
      const float pdf = c.shape->pdf(c.reference, {s->position, s->normal, s->normal}, s->primitive, s->wi, s->distance);
      EXPECT_NEAR(pdf / s->pdf_solid_angle, 1, 2e-3f) << c.name;
    }
  }
}

// The mean of 1/pdf is the solid angle of what is seen, and of cos/pdf over pi the form factor: both known in closed form.
double mean_over_samples(const Shape& shape, Vec3f reference, double (*value)(const ShapeSample&)) {
  const int side = 512;
  double sum = 0;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const auto s = shape.sample(reference, {(static_cast<float>(i) + 0.5f) / side, (static_cast<float>(j) + 0.5f) / side});
      if (s) sum += value(*s) / static_cast<double>(s->pdf_solid_angle);
    }
  }
  return sum / (side * side);
}

double one(const ShapeSample&) { return 1; }
double form_factor_up(const ShapeSample& s) { return std::max(0.0f, s.wi.z) / kPi; }

TEST(ShapeAsLight, InverseDensityAddsUpToTheSolidAngle) {
  const double pi = std::numbers::pi;
  // A sphere of radius 1 from distance 2 fills the cone with sine 1/2.
  EXPECT_NEAR(mean_over_samples(Sphere({0, 0, 2}, 1, false), {}, one), 2 * pi * (1 - std::sqrt(0.75)), 1e-4);
  EXPECT_NEAR(mean_over_samples(Sphere({0, 0, 0.5f}, 1, true), {}, one), 4 * pi, 1e-2);
  // Squares of side 1 and 3 from distance 1 on the axis: the second is sampled by solid angle, the first by area.
  for (const float side : {0.4f, 1.0f, 3.0f}) {
    const double a = static_cast<double>(side) / 2;
    const double expected = 4 * std::asin(a * a / (1 + a * a));
    const Rectangle square({-side / 2, -side / 2, 1}, {side, 0, 0}, {0, side, 0}, true);
    EXPECT_NEAR(mean_over_samples(square, {}, one), expected, 2e-4 * expected) << side;
    // Twin: a density that is 1 % off is seen.
    EXPECT_GT(std::abs(mean_over_samples(square, {}, one) * 1.01 - expected), 2e-4 * expected);
  }
}

TEST(ShapeAsLight, FormFactorsD4AndD5OfADisk) {
  EXPECT_NEAR(mean_over_samples(Disk({0, 0, 1}, {0, 0, -1}, {1, 0, 0}, 1), {}, form_factor_up), 0.5, 1e-4);
  EXPECT_NEAR(mean_over_samples(Disk({0.6f, 0, 0.8f}, {0, 0, -1}, {1, 0, 0}, 0.5f), {}, form_factor_up), 0.1580294, 1e-4);
}

TEST(ShapeAsLight, FormFactorsD2AndD3OfARectangle) {
  EXPECT_NEAR(mean_over_samples(Rectangle({0, 0, 0.7f}, {1, 0, 0}, {0, 0.5f, 0}, true), {}, form_factor_up), 0.1302817, 1e-4);
  EXPECT_NEAR(mean_over_samples(Rectangle({0.7f, 0, 0}, {0, 0.5f, 0}, {0, 0, 1}, true), {}, form_factor_up), 0.0632331, 1e-4);
}

// p-value of the samples of a shape against the density that pdf() states where a ray meets it; `scale` spoils the density.
double sampling_p_value(const LightCase& c, double scale) {
  RayAccelerator accelerator(1);
  if (const auto* sphere = dynamic_cast<const Sphere*>(c.shape.get())) accelerator.add(*sphere);
  if (const auto* disk = dynamic_cast<const Disk*>(c.shape.get())) accelerator.add(*disk);
  if (const auto* rectangle = dynamic_cast<const Rectangle*>(c.shape.get())) accelerator.add(*rectangle);
  if (const auto* mesh = dynamic_cast<const TriangleMesh*>(c.shape.get())) accelerator.add(*mesh);
  accelerator.build();
  const auto density = [&](Vec3f wi) {
    const Ray ray{c.reference, wi};
    Hit hit;
    if (!accelerator.intersect(ray, hit)) return 0.0;
    const SurfacePoint point = c.shape->surface_point(ray, hit);
    // Twin: brighter towards one side.
    return static_cast<double>(c.shape->pdf(c.reference, point, hit.primitive, wi, hit.t)) *
           (1 + scale * static_cast<double>(wi.x));
  };
  const auto sample = [&](float, Vec2f u) -> std::optional<Vec3f> {
    const auto s = c.shape->sample(c.reference, u);
    if (!s) return std::nullopt;
    return s->wi;
  };
  return chi_square({.chart = {{0, 0, 1}, 1.5}, .samples = 50000, .strips = 16}, sample, density).p_value;
}

TEST(ShapeAsLight, SamplesFollowTheDensity) {
  const std::vector<LightCase> all = cases();
  const double level = sidak_level(0.01, static_cast<int>(all.size()));  // 1 % over all cases
  for (const LightCase& c : all) EXPECT_GT(sampling_p_value(c, 0), level) << c.name;
}

TEST(ShapeAsLight, TwinWithATiltedDensityIsRejected) {
  const std::vector<LightCase> all = cases();
  const double level = sidak_level(0.01, static_cast<int>(all.size()));
  for (const LightCase& c : all) EXPECT_LT(sampling_p_value(c, 0.9), level) << c.name;
}

TEST(SphericalTriangle, OctantOfTheSphereIsSampledUniformly) {
  // Mean direction over the octant is (1/2, 1/2, 1/2): the integral of each coordinate is pi/4 over a solid angle of pi/2.
  const SphericalTriangle octant({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {});
  EXPECT_NEAR(octant.solid_angle(), kPi / 2, 1e-5f);
  Vec3f mean;
  const int side = 256;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const Vec3f w = octant.sample({(static_cast<float>(i) + 0.5f) / side, (static_cast<float>(j) + 0.5f) / side});
      EXPECT_NEAR(length(w), 1, 1e-4f);
      mean += w / (side * side);
    }
  }
  EXPECT_NEAR(mean.x, 0.5f, 1e-3f);
  EXPECT_NEAR(mean.y, 0.5f, 1e-3f);
  EXPECT_NEAR(mean.z, 0.5f, 1e-3f);
}

TEST(SphericalRectangle, SolidAngleOfTheOctantIsAnEighthOfTheSphere) {
  const SphericalRectangle seen({0, 0, 1e-3f}, {1, 0, 0}, {0, 1, 0}, 1e3f, 1e3f, {});
  EXPECT_NEAR(seen.solid_angle(), kPi / 2, 1e-3f);
}

}  // namespace
}  // namespace fluxfarm::testing
