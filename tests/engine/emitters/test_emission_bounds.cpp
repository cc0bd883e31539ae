// Bounds of the rays that leave a part of an emitter: each ray of the part that passes near a ball is known to do so.
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <random>

#include "emitters/directional_emitter.h"
#include "emitters/envmap_emitter.h"
#include "emitters/spot_emitter.h"
#include "geometry/disk.h"
#include "geometry/rectangle.h"
#include "geometry/sphere.h"
#include "geometry/triangle_mesh.h"
#include "support/scene_builder.h"
#include "support/sky.h"

namespace fluxfarm {
namespace {

constexpr Vec3f kSceneCenter{0.3f, -0.2f, 0.5f};
constexpr float kSceneRadius = 3;

class Random {
 public:
  float number() { return static_cast<float>(generator_() >> 8) * 0x1p-24f; }
  Vec2f pair() { return {number(), number()}; }
  Vec3f direction() { return square_to_uniform_sphere(pair()); }
  // Dyadic, as small as 1/4096 of each side.
  UnitBox box() {
    UnitBox box;
    const auto cut = [&](float Vec2f::*side) {
      const auto parts = static_cast<float>(1u << (generator_() % 13));
      box.lower.*side = std::floor(number() * parts) / parts;
      box.upper.*side = box.lower.*side + 1 / parts;
    };
    cut(&Vec2f::x);
    cut(&Vec2f::y);
    return box;
  }

 private:
  std::mt19937 generator_{11};
};

// Of balls that a ray only just meets, how many the bounds of its cell deny.
struct Answers {
  int rays = 0, denied = 0;
};

Answers ask(const Emitter& emitter, float shrink) {
  Random random;
  Answers answers;
  for (int i = 0; i < 20000; ++i) {
    const EmissionCell cell{random.box(), random.box()};
    const EmissionBounds bounds = emitter.emission_bounds(cell, kSceneCenter);
    const auto may_meet = [&](const Ball& ball) {
      return std::any_of(bounds.begin(), bounds.end(),
                         [&](const auto& rays) { return std::visit([&](const auto& r) { return r.may_meet(ball); }, rays); });
    };
    const auto emission = emitter.emit(cell.point.at(random.pair()), cell.direction.at(random.pair()), kSceneCenter);
    if (!emission) continue;
    const float radius = 0.3f * random.number();
    const Vec3f across = normalize(cross(emission->ray.direction, random.direction()));
    const float distance = 1 + 3 * random.number();
    const Vec3f center = emission->ray.origin + distance * emission->ray.direction + 0.999f * radius * across;
    ++answers.rays;
    answers.denied += !may_meet({center, radius * shrink});
  }
  return answers;
}

TEST(EmissionBounds, HoldEveryRay) {
  const Rectangle rectangle({0, 1, 0}, {0.5f, 0.1f, 0}, {0, 0.2f, 0.4f}, false);
  const Disk disk({0.2f, 0.3f, 0}, normalize(Vec3f{1, 0.3f, 0}), normalize(Vec3f{-0.3f, 1, 0}), 0.4f);
  const Sphere sphere({0.1f, 0.5f, 0.2f}, 0.3f, false), hollow({0.1f, 0.5f, 0.2f}, 2, true);
  const MeshDescription cube = testing::cube(Transform::translate(0.1, 0.2, 0.3) * Transform::rotate(1, 2, 3, 40));
  const TriangleMesh mesh({cube.positions, {}, {}, cube.indices}, false, true);
  const auto area = [](const Shape& shape, bool both_sides = false) {
    return std::make_unique<AreaEmitter>(shape, Rgb{1}, both_sides);
  };
  const auto turn = Transform::rotate(1, 0.5, 0.2, 40) * Transform::scale(1, 1, -1);
  std::vector<std::pair<const char*, std::unique_ptr<Emitter>>> emitters;
  emitters.emplace_back("point", std::make_unique<PointEmitter>(Vec3f{1, 0, 1}, Rgb{1}));
  emitters.emplace_back("spot", std::make_unique<SpotEmitter>(Vec3f{1, 0, 1}, normalize(Vec3f{1, 2, 3}), Rgb{1}, 0.6f, 0.2f));
  emitters.emplace_back("wide spot", std::make_unique<SpotEmitter>(Vec3f{1, 0, 1}, Vec3f{0, 0, -1}, Rgb{1}, 2.9f, 2));
  emitters.emplace_back("directional", std::make_unique<DirectionalEmitter>(normalize(Vec3f{1, 2, -3}), Rgb{1}, kSceneRadius));
  emitters.emplace_back("map", std::make_unique<EnvmapEmitter>(testing::patchy_sky(16, 9), turn, kSceneRadius));
  emitters.emplace_back("map with sun", std::make_unique<EnvmapEmitter>(testing::sunny_sky(), turn, kSceneRadius));
  emitters.emplace_back("rectangle", area(rectangle));
  emitters.emplace_back("rectangle of two sides", area(rectangle, true));
  emitters.emplace_back("disk", area(disk));
  emitters.emplace_back("sphere", area(sphere));
  emitters.emplace_back("hollow sphere", area(hollow));
  emitters.emplace_back("triangles", area(mesh));
  emitters.emplace_back("triangles of two sides", area(mesh, true));
  for (const auto& [name, emitter] : emitters) {
    const Answers right = ask(*emitter, 1), twin = ask(*emitter, 0.5f);
    EXPECT_GT(right.rays, 15000) << name;
    EXPECT_EQ(right.denied, 0) << name;
    EXPECT_GT(twin.denied, 0) << name;  // rays that miss the ball
  }
}

}  // namespace
}  // namespace fluxfarm
