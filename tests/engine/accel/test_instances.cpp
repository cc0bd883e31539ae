// Instances of one mesh against copies of it in the world: same hits, same surfaces.
#include <gtest/gtest.h>

#include <random>

#include "accel/ray_accelerator.h"

namespace fluxfarm {
namespace {

// A tetrahedron with normals and texture coordinates.
TriangleMesh::Data tetrahedron() {
  TriangleMesh::Data data;
  data.positions = {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}};
  for (const Vec3f& p : data.positions) data.normals.push_back(normalize(p));
  data.uvs = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
  data.indices = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  return data;
}

// As a reader copies it into the world: corners turned where the map mirrors.
TriangleMesh::Data copied(TriangleMesh::Data data, const Transform& to_world) {
  for (Vec3f& p : data.positions) p = to_world.point(p);
  for (Vec3f& n : data.normals) n = normalize(to_world.normal(n));
  if (to_world.determinant() < 0)
    for (std::size_t i = 0; i < data.indices.size(); i += 3) std::swap(data.indices[i + 1], data.indices[i + 2]);
  return data;
}

std::vector<Transform> places() {
  return {Transform(), Transform::translate(4, 0, 1) * Transform::rotate(1, 2, 3, 50) * Transform::scale(0.5, 1.5, 1),
          Transform::translate(-4, 1, 0) * Transform::scale(-1, 1, 2),  // mirrors
          Transform::translate(0, 5, 0) * Transform::rotate(0, 1, 0, 30)};
}

// The same places as instances, and as copies; a sphere in between, so that numbers of shapes and of geometries differ.
class InstancesAndCopies : public testing::Test {
 protected:
  InstancesAndCopies() : mesh_(tetrahedron(), false, false), instanced_(1), copies_(1) {
    for (const Transform& place : places()) {
      instances_.push_back(std::make_unique<MeshInstance>(mesh_, mesh_.bounds(), place));
      meshes_.push_back(std::make_unique<TriangleMesh>(copied(tetrahedron(), place), false, false));
      instanced_.add(*instances_.back());
      copies_.add(*meshes_.back());
      if (instances_.size() == 2) {
        instanced_.add(sphere_);
        copies_.add(sphere_);
      }
    }
    instanced_.build();
    copies_.build();
  }

  std::vector<Ray> rays(std::size_t count) const {
    std::mt19937 generator(5);
    std::uniform_real_distribution<float> uniform(-1, 1);
    std::vector<Ray> result;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3f origin{8 * uniform(generator), 8 * uniform(generator), 8};
      const Vec3f target{6 * uniform(generator), 4 * uniform(generator) + 1, uniform(generator)};
      result.push_back({origin, normalize(target - origin)});
    }
    return result;
  }
  // Of the shapes in the order in which they were added; the sphere is number 2.
  static std::size_t place_of(std::uint32_t shape) { return shape < 2 ? shape : shape - 1; }

  TriangleMesh mesh_;
  Sphere sphere_{{0, -3, 0}, 1, false};
  std::vector<std::unique_ptr<MeshInstance>> instances_;
  std::vector<std::unique_ptr<TriangleMesh>> meshes_;
  RayAccelerator instanced_, copies_;
};

TEST_F(InstancesAndCopies, HitsAndSurfacesAgree) {
  std::array<int, 5> hits{};
  int differ = 0;
  for (const Ray& ray : rays(20000)) {
    Hit a, b;
    const bool hit_a = instanced_.intersect(ray, a), hit_b = copies_.intersect(ray, b);
    // Rays along an edge may go either way.
    if (hit_a != hit_b || (hit_a && (a.shape != b.shape || a.primitive != b.primitive))) {
      ++differ;
      continue;
    }
    EXPECT_EQ(instanced_.occluded(ray), hit_a);
    if (!hit_a) continue;
    ++hits[a.shape];
    ASSERT_NEAR(a.t, b.t, 1e-4f);
    if (a.shape == 2) continue;
    // A mirrored copy has its second and third corner exchanged.
    const MeshInstance& instance = *instances_[place_of(a.shape)];
    const TriangleMesh& copy = *meshes_[place_of(a.shape)];
    const SurfacePoint p = instance.surface_point(ray, a), q = copy.surface_point(ray, b);
    ASSERT_NEAR(length(p.position - q.position), 0, 1e-4f);
    ASSERT_NEAR(length(p.geometric_normal - q.geometric_normal), 0, 1e-5f);
    // Interpolated before the map or after it: the same direction only where the map keeps lengths.
    ASSERT_GT(dot(p.shading_normal, q.shading_normal), 0.9f);
    ASSERT_NEAR(length(p.shading_normal), 1, 1e-5f);
    const Vec2f uv = instance.uv(p, a), copied_uv = copy.uv(q, b);
    ASSERT_NEAR(uv.x, copied_uv.x, 1e-4f);
    ASSERT_NEAR(uv.y, copied_uv.y, 1e-4f);
    ASSERT_NEAR(std::abs(dot(instance.tangent(p, a), copy.tangent(q, b))), 1, 1e-4f);
  }
  for (const int count : hits) EXPECT_GT(count, 200);
  EXPECT_LT(differ, 20);
}

TEST_F(InstancesAndCopies, PacketsNameTheInstance) {
  const std::vector<Ray> all = rays(640);
  std::vector<Hit> hits(all.size());
  instanced_.intersect(all, hits, false);
  int found = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    Hit single;
    if (!instanced_.intersect(all[i], single)) single.shape = Hit::kNone;
    EXPECT_EQ(hits[i].shape, single.shape);
    found += single.shape != Hit::kNone;
  }
  EXPECT_GT(found, 100);
}

TEST_F(InstancesAndCopies, BoundsHoldTheInstanceAndAreasAgree) {
  for (std::size_t i = 0; i < instances_.size(); ++i) {
    const Bounds box = instances_[i]->bounds(), tight = meshes_[i]->bounds();
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LE(box.lower[axis], tight.lower[axis] + 1e-5f);
      EXPECT_GE(box.upper[axis], tight.upper[axis] - 1e-5f);
    }
    EXPECT_NEAR(instances_[i]->area(), meshes_[i]->area(), 1e-4f);
  }
}

// Twin: normals that are moved like vectors are wrong under a scale that differs between the axes.
TEST(InstanceTwin, NormalsMovedAsVectorsAreRejected) {
  const Transform place = places()[1];
  const Vec3f n = normalize(Vec3f{1, 1, 1});
  EXPECT_GT(length(normalize(place.normal(n)) - normalize(place.vector(n))), 0.1f);
}

}  // namespace
}  // namespace fluxfarm
