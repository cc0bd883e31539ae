// The tree that finds boxes that hold a place.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "integrators/irradiance/bounds_tree.h"

namespace fluxfarm {
namespace {

bool holds(const Bounds& b, Vec3f p) {
  return p.x >= b.lower.x && p.x <= b.upper.x && p.y >= b.lower.y && p.y <= b.upper.y && p.z >= b.lower.z && p.z <= b.upper.z;
}

// How many boxes of a tree of `count` are visited for a place, on average, in space stretched by `scale`; those that hold it have
// to be.
double visits(std::size_t count, Vec3f scale) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0, 1);
  const auto any = [&] { return Vec3f{unit(random) * scale.x, unit(random) * scale.y, unit(random) * scale.z}; };
  std::vector<Bounds> boxes(count);
  for (Bounds& box : boxes) {
    const Vec3f at = any(), size = any() * 0.1f;
    box.extend(at);
    box.extend(at + size);
  }
  const BoundsTree tree(boxes);
  constexpr int kPlaces = 500;
  std::size_t visited = 0;
  for (int i = 0; i < kPlaces; ++i) {
    // At their very corners, too.
    const Vec3f place = i % 3 == 0 ? boxes[static_cast<std::size_t>(i) % count].lower
                                   : (i % 3 == 1 ? boxes[static_cast<std::size_t>(i) % count].upper : any());
    std::vector<bool> seen(count);
    tree.for_each_near(place, [&](std::uint32_t leaf) {
      seen[tree.order()[leaf]] = true;
      ++visited;
      return true;
    });
    for (std::size_t b = 0; b < count; ++b) {
      EXPECT_TRUE(seen[b] || !holds(boxes[b], place)) << b;
    }
  }
  return static_cast<double>(visited) / kPlaces;
}

TEST(BoundsTree, VisitsAllBoxesThatHoldAPlaceAndFewOthers) {
  EXPECT_LT(visits(1000, {1, 1, 1}), 20);
  EXPECT_LT(visits(1000, {1e-4f, 1e4f, 1}), 20);
  EXPECT_LT(visits(1000, {3, 5, 0}), 40);  // flat
  EXPECT_EQ(visits(3, {1, 1, 1}), visits(3, {2, 2, 2}));
}

TEST(BoundsTree, TakesWhatHasNoSize) {
  EXPECT_GT(visits(10, {0, 0, 0}), 0);
  EXPECT_GT(visits(10, {1e-40f, 1e-42f, 1}), 0);
}

TEST(BoundsTree, StopsWhenTold) {
  const std::vector<Bounds> boxes(5, Bounds{{0, 0, 0}, {1, 1, 1}});
  int visited = 0;
  BoundsTree(boxes).for_each_near({0.5f, 0.5f, 0.5f}, [&](std::uint32_t) { return ++visited < 2; });
  EXPECT_EQ(visited, 2);
  BoundsTree().for_each_near({0, 0, 0}, [&](std::uint32_t) { return ++visited < 2; });
  EXPECT_EQ(visited, 2);
}

}  // namespace
}  // namespace fluxfarm
