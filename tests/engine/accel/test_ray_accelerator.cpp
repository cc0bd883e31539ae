// Hits against arithmetic done by hand, and packets against single rays.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "accel/ray_accelerator.h"

namespace fluxfarm {
namespace {

class MixedScene : public testing::Test {
 protected:
  MixedScene() : accelerator_(1) {
    accelerator_.add(sphere_);
    accelerator_.add(disk_);
    accelerator_.add(rectangle_);
    accelerator_.add(mesh_);
    accelerator_.build();
  }

  Sphere sphere_{{0, 0, 5}, 1, false};
  Disk disk_{{3, 0, 5}, {0, 0, -1}, {1, 0, 0}, 1};
  Rectangle rectangle_{{-4, -1, 5}, {2, 0, 0}, {0, 2, 0}, false};
  TriangleMesh mesh_{{{{-9, -9, 9}, {9, -9, 9}, {9, 9, 9}, {-9, 9, 9}}, {}, {}, {0, 2, 1, 0, 3, 2}}, false, false};
  RayAccelerator accelerator_;
};

TEST_F(MixedScene, FindsTheNearestShapeAndItsDistance) {
  const auto expect_hit = [&](Vec3f origin, Vec3f direction, std::uint32_t shape, float t) {
    Hit hit;
    ASSERT_TRUE(accelerator_.intersect({origin, direction}, hit));
    EXPECT_EQ(hit.shape, shape);
    EXPECT_NEAR(hit.t, t, 1e-5f);
  };
  expect_hit({0, 0, 0}, {0, 0, 1}, 0, 4);
  expect_hit({0, 0, 5}, {0, 0, 1}, 0, 1);  // from inside the sphere
  expect_hit({0.6f, 0, 0}, {0, 0, 1}, 0, 4.2f);
  expect_hit({3, 0.9f, 0}, {0, 0, 1}, 1, 5);
  expect_hit({-3, 0.5f, 0}, {0, 0, 1}, 2, 5);
  expect_hit({3, 1.1f, 0}, {0, 0, 1}, 3, 9);  // past the disk
  Hit hit;
  EXPECT_FALSE(accelerator_.intersect({{0, 0, 0}, {0, 0, -1}}, hit));
}

TEST_F(MixedScene, RespectsTheIntervalOfTheRay) {
  EXPECT_TRUE(accelerator_.occluded({{0, 0, 0}, {0, 0, 1}, 0, 4.1f}));
  EXPECT_FALSE(accelerator_.occluded({{0, 0, 0}, {0, 0, 1}, 0, 3.9f}));
  EXPECT_FALSE(accelerator_.occluded({{0, 0, 0}, {0, 0, 1}, 6.1f, 8.9f}));
  EXPECT_TRUE(accelerator_.occluded({{0, 0, 0}, {0, 0, 1}, 5, 6.1f}));  // the far side of the sphere
}

TEST_F(MixedScene, PacketsOfAnySizeFindWhatSingleRaysFind) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (const std::size_t count : {1u, 3u, 4u, 15u, 16u, 17u, 40u, 64u}) {
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count; ++i) {
      rays.push_back({{uniform(generator), uniform(generator), 0}, normalize(Vec3f{uniform(generator), uniform(generator), 1})});
    }
    std::vector<Hit> hits(count);
    const auto blocked = std::make_unique<bool[]>(count);
    accelerator_.intersect(rays, hits, count % 2 == 0);
    accelerator_.occluded(rays, {blocked.get(), count}, count % 2 == 0);
    for (std::size_t i = 0; i < count; ++i) {
      Hit single;
      const bool found = accelerator_.intersect(rays[i], single);
      EXPECT_EQ(hits[i].shape, found ? single.shape : Hit::kNone);
      if (found) {
        EXPECT_NEAR(hits[i].t, single.t, 1e-4f * single.t);
      }
      EXPECT_EQ(blocked[i], found);
    }
  }
}

TEST(RayAccelerator, EmptySceneHasNoHits) {
  RayAccelerator accelerator(1);
  accelerator.build();
  Hit hit;
  EXPECT_FALSE(accelerator.intersect({{0, 0, 0}, {0, 0, 1}}, hit));
}

// A ray that leaves a surface from the offset point must not meet it again, at any scale and place.
TEST(OffsetPoint, KeepsRaysOffTheirOwnSurface) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<float> uniform(-1, 1);
  int met_again = 0, met_without_offset = 0;
  for (const float scale : {1e-3f, 1.0f, 1e4f}) {
    const TriangleMesh mesh(
        {{scale * Vec3f{-1, 0.3f, -1}, scale * Vec3f{1, 0.1f, -1.2f}, scale * Vec3f{0, -0.2f, 1}}, {}, {}, {0, 2, 1}}, false,
        false);
    RayAccelerator accelerator(1);
    accelerator.add(mesh);
    accelerator.build();
    for (int i = 0; i < 3000; ++i) {
      const Ray down{scale * Vec3f{0.3f * uniform(generator), 2, -0.3f + 0.3f * uniform(generator)}, {0, -1, 0}};
      Hit hit;
      ASSERT_TRUE(accelerator.intersect(down, hit));
      const SurfacePoint point = mesh.surface_point(down, hit);
      Vec3f out = normalize(Vec3f{uniform(generator), uniform(generator), uniform(generator)});
      if (dot(out, point.geometric_normal) < 0) out = -out;
      met_again += accelerator.occluded({offset_point(point.position, point.geometric_normal), out});
      met_without_offset += accelerator.occluded({point.position, out});
    }
  }
  EXPECT_EQ(met_again, 0);
  EXPECT_GT(met_without_offset, 100) << "the test would not notice a missing offset";
}

}  // namespace
}  // namespace fluxfarm
