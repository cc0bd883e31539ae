// Path tracing under many lights: what the choice of emitters leaves out, another one would find.
//
// Each comparison is a two-sided z-test at an overall level of 1 % over all of them (Sidak) and has a twin that must fail.
#include <gtest/gtest.h>

#include "support/scene_builder.h"

namespace fluxfarm::testing {
namespace {

// Two-sided normal quantile at 1 - (1 - 0.01)^(1/10) = 1.0e-3: there are fewer than 10 comparisons below.
constexpr double kZ = 3.29;
constexpr float kRho = 0.8f;

// A lamp over a floor, in one piece or as a mesh of n x n squares of two triangles.
MeshDescription lamp(int n) {
  MeshDescription mesh;
  const auto at = [n](int i) { return -1 + 2 * static_cast<float>(i) / static_cast<float>(n); };
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) mesh.positions.push_back({at(x), 1, at(y)});
  }
  const auto index = [n](int x, int y) { return static_cast<std::uint32_t>(y * (n + 1) + x); };
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      // Counter-clockwise as seen from below.
      for (const auto& [i, k] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}})
        mesh.indices.push_back(index(x + i, y + k));
    }
  }
  return mesh;
}

SceneBuilder under_lamps(int material_of(SceneBuilder&), const std::vector<int>& pieces) {
  SceneBuilder scene;
  scene.floor(0, 20, material_of(scene));
  for (const int n : pieces) scene.shape(lamp(n), scene.diffuse(0), 2 / static_cast<float>(pieces.size()));
  return scene.look({-2.5, 1.5, 0.7}, {0.3, 0, 0.2}).max_depth(2);
}

int diffuse(SceneBuilder& scene) { return scene.diffuse(kRho); }

int rough_metal(SceneBuilder& scene) {
  RoughConductorDescription metal;
  metal.roughness.alpha_u = metal.roughness.alpha_v = 0.3f;
  return scene.add(metal);
}

int rough_glass(SceneBuilder& scene) {
  RoughDielectricDescription glass;
  glass.roughness.alpha_u = glass.roughness.alpha_v = 0.4f;
  return scene.add(glass);
}

void expect_same(const Measurement& one, const Measurement& many) {
  const double error = std::hypot(one.standard_error, many.standard_error);
  EXPECT_LE(error, 0.005 * one.mean) << "too noisy";
  EXPECT_LE(std::abs(one.mean - many.mean), kZ * error) << one.mean << " " << many.mean;
  EXPECT_GT(std::abs(1.03 * one.mean - many.mean), kZ * error) << "the test has no teeth";
}

TEST(ManyLights, LampOfManyTrianglesShinesAsOneOfTwo) {
  for (const auto material : {diffuse, rough_metal}) {
    expect_same(measure(under_lamps(material, {1}).description(), 1024),
                measure(under_lamps(material, {16}).description(), 1024, 2));
  }
}

TEST(ManyLights, LightFromBehindARoughGlassIsFound) {
  // From below: the choice must look to both sides of a surface that light crosses.
  const auto below = [](const std::vector<int>& pieces) {
    return under_lamps(rough_glass, pieces).look({0.4, -1.2, 0.3}, {0.3, 0, 0.2}).description();
  };
  expect_same(measure(below({1}), 4096), measure(below({16}), 4096, 2));
}

// Lamps of all kinds around one point of a floor, one by one and together; some cannot reach it.
TEST(ManyLights, AddUpToTheSumOfEach) {
  const auto lamps = [](SceneBuilder& scene, int kind) {
    const int black = scene.diffuse(0);
    for (int i = 0; i < 6; ++i) {
      const float x = static_cast<float>(i) - 2.5f;
      if (kind == 0) scene.emitter(PointEmitterDescription{{x, 0.5f + 0.2f * x * x, 1}, Rgb{1.0f}});
      if (kind == 1) scene.emitter(SpotEmitterDescription{{x, 1, -1}, normalize(Vec3f{-x, -1, 1}), Rgb{3.0f}, 100, 10});
      if (kind == 2) scene.lamp_down(x, 1 + 0.3f * x, 2, 0.4f, 0.6f, black, 5);
      if (kind == 3) scene.shape(SphereDescription{{x, 1.5f, -2}, 0.3f}, black, 4);
    }
    if (kind == 2) scene.shape(lamp(8), black, 0.5f, true);  // shines upwards, on nothing
  };
  const auto scene_with = [&](const std::vector<int>& kinds) {
    SceneBuilder scene;
    scene.floor(0, 20, scene.diffuse(kRho));
    for (const int kind : kinds) lamps(scene, kind);
    return scene.look({-0.3, 0.3, 0.1}, {0, 0, 0}).max_depth(2).description();
  };
  double sum = 0, variance = 0;
  for (const int kind : {0, 1, 2, 3}) {
    const Measurement m = measure(scene_with({kind}), 1024);
    sum += m.mean;
    variance += m.standard_error * m.standard_error;
  }
  expect_same({sum, std::sqrt(variance)}, measure(scene_with({0, 1, 2, 3}), 2048, 2));
}

TEST(ManyLights, FurnaceOfEmittingMeshesKeepsItsBalance) {
  SceneBuilder scene;
  const int wall = scene.diffuse(0.5f);
  scene.shape(cube(Transform::scale(3, 3, 3)), wall, 1, true);
  scene.shape(cube(Transform::translate(-1, 0.4, 0.5) * Transform::rotate(0.3, 1, 0.2, 70) * Transform::scale(0.5, 0.9, 0.6)), wall,
              1);
  scene.look({1, 1, -1}, {0.5, -0.31, 0.4});
  const Measurement m = measure(scene.description(), 1024);
  EXPECT_LE(m.standard_error, 0.005 * 2);
  EXPECT_LE(m.z(2), kZ) << m.mean << " +- " << m.standard_error;
  EXPECT_GT(m.z(2 * 1.03), kZ) << "the test has no teeth";
}

}  // namespace
}  // namespace fluxfarm::testing
