// Texture coordinates of the shapes, against what Mitsuba 3.6.4 prints for the same rays.
#include <gtest/gtest.h>

#include <memory>

#include "accel/ray_accelerator.h"
#include "scene/make_shape.h"

namespace fluxfarm::testing {
namespace {

// A shape that rays down -z look for.
class ShapeBelow {
 public:
  template <typename Geometry>
  explicit ShapeBelow(const Geometry& geometry, bool flip_normals = false)
      : shape_(add_shape({"test shape", geometry, flip_normals, 0, {}}, false, shared_, accelerator_)) {
    accelerator_.build();
  }

  struct Meeting {
    SurfacePoint point;
    Hit hit;
  };
  Meeting meet(Vec3f origin) const {
    const Ray ray{origin, {0, 0, -1}};
    Hit hit;
    if (!accelerator_.intersect(ray, hit)) {
      ADD_FAILURE() << "the ray meets nothing";
      return {};
    }
    return {shape_->surface_point(ray, hit), hit};
  }
  const Shape& shape() const { return *shape_; }

 private:
  RayAccelerator accelerator_{1};
  SharedMeshes shared_;
  std::unique_ptr<Shape> shape_;
};

struct Place {
  Vec2f uv;
  Vec3f tangent;
};

template <typename Geometry>
Place place_below(const Geometry& geometry, Vec3f origin, bool flip_normals = false) {
  const ShapeBelow below(geometry, flip_normals);
  const auto [point, hit] = below.meet(origin);
  return {below.shape().uv(point, hit), below.shape().tangent(point, hit)};
}

void expect_near(Vec2f uv, Vec2f expected) {
  EXPECT_NEAR(uv.x, expected.x, 2e-6f);
  EXPECT_NEAR(uv.y, expected.y, 2e-6f);
}

// A sphere as the reader makes it from to_world.
SphereDescription sphere(const Transform& to_world, Vec3f center, float radius) {
  const auto axis = [&](Vec3f e) { return normalize(to_world.vector(e)); };
  SphereDescription d{to_world.point(center), radius, {}};
  d.axes.s = axis({1, 0, 0});
  d.axes.t = axis({0, 1, 0});
  d.axes.n = axis({0, 0, 1});
  return d;
}

// Moves along the derivatives and looks whether uv follows.
template <typename Geometry>
void expect_derivatives_lead_along_uv(const Geometry& geometry, Vec3f origin, bool flip_normals = false) {
  const ShapeBelow below(geometry, flip_normals);
  const Shape& shape = below.shape();
  const auto [point, hit] = below.meet(origin);
  const Vec2f uv = shape.uv(point, hit);
  const Shape::UvDerivatives d = shape.uv_derivatives(point, hit);
  constexpr float kStep = 2e-3f;
  for (const bool along_u : {true, false}) {
    const Vec3f step = (along_u ? d.dp_du : d.dp_dv) * kStep;
    const auto [p, h] = below.meet({point.position.x + step.x, point.position.y + step.y, origin.z});
    const Vec2f moved = shape.uv(p, h);
    EXPECT_NEAR((moved.x - uv.x) / kStep, along_u ? 1 : 0, 0.03) << along_u;
    EXPECT_NEAR((moved.y - uv.y) / kStep, along_u ? 0 : 1, 0.03) << along_u;
  }
}

TEST(UvDerivatives, LeadAlongUvOnEveryShape) {
  const Transform stretched = Transform::rotate(0, 1, 0, 20) * Transform::scale(2, 0.7, 1);
  expect_derivatives_lead_along_uv(RectangleDescription{stretched}, {0.3f, 0.2f, 5});
  expect_derivatives_lead_along_uv(RectangleDescription{stretched}, {0.3f, 0.2f, 5}, true);
  for (const bool flipped : {false, true}) {
    expect_derivatives_lead_along_uv(DiskDescription{Transform::scale(2, 2, 2)}, {0.3f, 0.5f, 5}, flipped);
    expect_derivatives_lead_along_uv(DiskDescription{Transform::scale(2, -2, 2)}, {0.3f, 0.5f, 5}, flipped);
    const Transform turned = Transform::rotate(0, 1, 0, 30) * Transform::rotate(1, 0, 0, 40);
    expect_derivatives_lead_along_uv(sphere(turned, {0.1f, 0, 0}, 2), {0.5f, 0.4f, 5}, flipped);
    expect_derivatives_lead_along_uv(sphere(turned * Transform::scale(-1, 1, 1), {}, 2), {0.5f, 0.4f, 5}, flipped);
  }
  MeshDescription mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0.5f}, {0, 1, 0}};
  mesh.uvs = {{0.1f, 0.2f}, {0.3f, 0.9f}, {0.8f, 0.4f}};
  mesh.indices = {0, 1, 2};
  expect_derivatives_lead_along_uv(mesh, {0.1f, -0.2f, 5});
  mesh.uvs.clear();
  expect_derivatives_lead_along_uv(mesh, {0.1f, -0.2f, 5});
}

TEST(VertexColours, LieBetweenThoseOfTheCorners) {
  MeshDescription mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  mesh.colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.indices = {0, 1, 2};
  const ShapeBelow below(mesh);
  Hit hit;
  hit.u = 0.2f;
  hit.v = 0.3f;
  const Rgb c = below.shape().vertex_color(hit);
  EXPECT_NEAR(c.r, 0.5f, 1e-6f);
  EXPECT_NEAR(c.g, 0.2f, 1e-6f);
  EXPECT_NEAR(c.b, 0.3f, 1e-6f);
}

TEST(TextureCoordinates, RectangleRunsFromItsLowerLeftCorner) {
  expect_near(place_below(RectangleDescription{}, {0.3f, 0.5f, 1}).uv, {0.65f, 0.75f});
  expect_near(place_below(RectangleDescription{}, {-0.9f, 0.5f, 1}).uv, {0.05f, 0.75f});
  expect_near(place_below(RectangleDescription{}, {0.3f, 0.5f, 1}, true).uv, {0.65f, 0.75f});
}

TEST(TextureCoordinates, DiskHasRadiusAndAngle) {
  expect_near(place_below(DiskDescription{}, {0.3f, 0.5f, 1}).uv, {0.583095f, 0.163989f});
  expect_near(place_below(DiskDescription{}, {0.3f, -0.5f, 1}).uv, {0.583095f, 0.836011f});
  // Neither a flipped normal nor a mirrored frame changes what is painted in the disk's own space.
  expect_near(place_below(DiskDescription{}, {0.3f, 0.5f, 1}, true).uv, {0.583095f, 0.163989f});
  expect_near(place_below(DiskDescription{Transform::scale(1, -1, 1)}, {0.3f, 0.5f, 1}, true).uv, {0.583095f, 0.836011f});
}

TEST(TextureCoordinates, SphereHasLongitudeAndColatitudeAboutItsOwnAxis) {
  expect_near(place_below(sphere({}, {}, 1), {0.3f, 0.5f, 3}).uv, {0.163989f, 0.198159f});
  expect_near(place_below(sphere({}, {}, 1), {0.3f, -0.5f, 3}).uv, {0.836011f, 0.198159f});
  const Transform turned = Transform::rotate(0, 1, 0, 30) * Transform::rotate(1, 0, 0, 40);
  expect_near(place_below(sphere(turned, {1, 0, 0}, 2), {1.3f, 0.5f, 3}).uv, {0.305129f, 0.315228f});
  expect_near(place_below(sphere(turned, {1, 0, 0}, 2), {0.3f, -0.5f, 3}).uv, {0.449408f, 0.267752f});
  const Transform mirrored = turned * Transform::scale(-1, 1, 1);
  expect_near(place_below(sphere(mirrored, {}, 2), {1.3f, 0.5f, 3}, true).uv, {0.289761f, 0.309124f});
}

TEST(TextureCoordinates, TwinSphereThatForgetsItsRotationIsFound) {
  const Transform turned = Transform::rotate(0, 1, 0, 30) * Transform::rotate(1, 0, 0, 40);
  SphereDescription d = sphere(turned, {1, 0, 0}, 2);
  d.axes = {};
  EXPECT_GT(std::fabs(place_below(d, {1.3f, 0.5f, 3}).uv.x - 0.305129f), 0.05f);
}

// The tangent of a sphere points along growing u: a finite difference of uv.
TEST(TextureCoordinates, TangentOfATurnedSpherePointsAlongU) {
  const SphereDescription d = sphere(Transform::rotate(0, 1, 0, 30) * Transform::rotate(1, 0, 0, 40), {}, 1);
  const Vec3f origin{0.2f, 0.3f, 3};
  const Place here = place_below(d, origin);
  const float step = 1e-3f;
  const Place there = place_below(d, origin + step * here.tangent);
  EXPECT_GT(there.uv.x - here.uv.x, step / kTwoPi / 2);
  EXPECT_NEAR(there.uv.y, here.uv.y, 1e-5f);
}

TEST(TextureCoordinates, MeshInterpolatesThoseOfItsVertices) {
  MeshDescription mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.uvs = {{0.1f, 0.9f}, {1.1f, 0.7f}, {0.3f, -0.1f}};
  mesh.indices = {0, 1, 2};
  expect_near(place_below(mesh, {0.25f, 0.5f, 1}).uv,
              {0.25f * 0.1f + 0.25f * 1.1f + 0.5f * 0.3f, 0.25f * 0.9f + 0.25f * 0.7f - 0.05f});
  mesh.uvs.clear();
  expect_near(place_below(mesh, {0.25f, 0.5f, 1}).uv, {0.25f, 0.5f});
}

}  // namespace
}  // namespace fluxfarm::testing
