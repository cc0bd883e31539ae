#include "integrators/photon/bounding_balls.h"

#include <algorithm>
#include <array>
#include <queue>

#include "geometry/disk.h"
#include "geometry/mesh_instance.h"
#include "geometry/rectangle.h"
#include "geometry/sphere.h"

namespace fluxfarm {
namespace {

// A square pane of that many balls is covered with a tenth of its edge to spare, at most.
constexpr std::size_t kBalls = 128;

using Triangle = std::array<Vec3f, 3>;

struct Piece {
  std::vector<Triangle> triangles;
  Ball ball;
  std::size_t order;  // of making, to decide between equals

  bool operator<(const Piece& other) const {
    return ball.radius != other.ball.radius ? ball.radius < other.ball.radius : order > other.order;
  }
};

Bounds box_of(const std::vector<Triangle>& triangles) {
  Bounds box;
  for (const Triangle& triangle : triangles) {
    for (const Vec3f corner : triangle) box.extend(corner);
  }
  return box;
}

Ball ball_of(const std::vector<Triangle>& triangles) {
  Ball ball{box_of(triangles).center(), 0};
  for (const Triangle& triangle : triangles) {
    for (const Vec3f corner : triangle) ball.radius = std::max(ball.radius, length(corner - ball.center));
  }
  return ball;
}

std::pair<std::vector<Triangle>, std::vector<Triangle>> bisect(std::vector<Triangle> triangles) {
  if (triangles.size() == 1) {  // at the middle of the longest edge
    Triangle t = triangles.front();
    const auto edge = [&](std::size_t i) { return length_squared(t[(i + 1) % 3] - t[i]); };
    while (edge(0) < edge(1) || edge(0) < edge(2)) std::rotate(t.begin(), t.begin() + 1, t.end());
    const Vec3f middle = 0.5f * (t[0] + t[1]);
    return {{{t[0], middle, t[2]}}, {{middle, t[1], t[2]}}};
  }
  const Bounds box = box_of(triangles);
  const Vec3f size = box.upper - box.lower;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto middle = triangles.begin() + static_cast<std::ptrdiff_t>(triangles.size() / 2);
  std::nth_element(triangles.begin(), middle, triangles.end(), [axis](const Triangle& a, const Triangle& b) {
    return a[0][axis] + a[1][axis] + a[2][axis] < b[0][axis] + b[1][axis] + b[2][axis];
  });
  return {{triangles.begin(), middle}, {middle, triangles.end()}};
}

std::vector<Triangle> triangles_of(const Shape& shape) {
  std::vector<Triangle> triangles;
  const auto add_quad = [&](Vec3f a, Vec3f b, Vec3f c, Vec3f d) { triangles.insert(triangles.end(), {{a, b, c}, {a, c, d}}); };
  const auto add_mesh = [&](const TriangleMesh& mesh, auto&& to_world) {
    for (std::size_t i = 0; i < mesh.triangles(); ++i) {
      const auto [a, b, c] = mesh.corners(static_cast<std::uint32_t>(i));
      triangles.push_back({to_world(a), to_world(b), to_world(c)});
    }
  };
  if (const auto* mesh = dynamic_cast<const TriangleMesh*>(&shape)) {
    add_mesh(*mesh, [](Vec3f p) { return p; });
  } else if (const auto* instance = dynamic_cast<const MeshInstance*>(&shape)) {
    add_mesh(instance->mesh(), [&](Vec3f p) { return instance->to_world().point(p); });
  } else if (const auto* rectangle = dynamic_cast<const Rectangle*>(&shape)) {
    add_quad(rectangle->corner(0), rectangle->corner(1), rectangle->corner(2), rectangle->corner(3));
  } else if (const auto* disk = dynamic_cast<const Disk*>(&shape)) {
    const Frame frame(disk->normal());
    const Vec3f s = disk->radius() * frame.s, t = disk->radius() * frame.t, c = disk->center();
    add_quad(c - s - t, c + s - t, c + s + t, c - s + t);
  }
  return triangles;
}

}  // namespace

std::vector<std::uint32_t> glossy_shapes(const Scene& scene) {
  std::vector<std::uint32_t> shapes;
  for (std::uint32_t shape = 0; shape < scene.census().shapes; ++shape) {
    if (scene.surface(shape).glossy) shapes.push_back(shape);
  }
  return shapes;
}

std::vector<Ball> bounding_balls(const Scene& scene, const std::vector<std::uint32_t>& shapes) {
  std::vector<Ball> balls;
  std::priority_queue<Piece> pieces;
  std::size_t order = 0;
  const auto add = [&](std::vector<Triangle> triangles) {
    const Ball ball = ball_of(triangles);
    pieces.push({std::move(triangles), ball, order++});
  };
  for (const std::uint32_t index : shapes) {
    const Shape& shape = *scene.surface(index).shape;
    if (const auto* sphere = dynamic_cast<const Sphere*>(&shape)) {
      balls.push_back({sphere->center(), sphere->radius()});
    } else if (std::vector<Triangle> triangles = triangles_of(shape); !triangles.empty()) {
      add(std::move(triangles));
    }
  }
  while (!pieces.empty() && pieces.size() < kBalls && pieces.top().ball.radius > 0) {
    auto [first, second] = bisect(pieces.top().triangles);
    pieces.pop();
    add(std::move(first));
    add(std::move(second));
  }
  for (; !pieces.empty(); pieces.pop()) balls.push_back(pieces.top().ball);
  return balls;
}

}  // namespace fluxfarm
