#include "geometry/triangle_mesh.h"

#include <utility>

#include "geometry/spherical_triangle.h"

namespace fluxfarm {
namespace {

Ball ball_around(const std::vector<Vec3f>& points) {
  Bounds box;
  for (const Vec3f p : points) box.extend(p);
  Ball ball{box.center(), 0};
  for (const Vec3f p : points) ball.radius = std::max(ball.radius, length(p - ball.center));
  return ball;
}

Cone cone_around(const std::vector<Vec3f>& normals) {
  Vec3f sum;
  for (const Vec3f n : normals) sum += n;
  if (!(length_squared(sum) > 0)) return {};
  Cone cone{normalize(sum), 0};
  constexpr float kMargin = 4e-6f;  // for rounding
  for (const Vec3f n : normals) {
    const float angle = std::atan2(length(cross(n, cone.axis)), dot(n, cone.axis));
    cone.half_angle = std::max(cone.half_angle, std::min(angle + kMargin, kPi));
  }
  return cone;
}

}  // namespace

TriangleMesh::TriangleMesh(Data data, bool flipped, bool emissive) : data_(std::move(data)), side_(flipped ? -1.0f : 1.0f) {
  data_.positions.reserve(data_.positions.size() + 1);  // ray tracing libraries read 16 bytes at each vertex
  std::vector<double> areas(triangles());
  double total = 0;
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const auto [a, b, c] = corners(static_cast<std::uint32_t>(i));
    areas[i] = 0.5 * static_cast<double>(length(cross(b - a, c - a)));
    total += areas[i];
  }
  area_ = static_cast<float>(total);
  if (!emissive) return;
  by_area_ = DiscreteDistribution(areas);
  ball_ = ball_around(data_.positions);
}

TriangleMesh::Corners TriangleMesh::corners(std::uint32_t triangle) const {
  const std::uint32_t* index = data_.indices.data() + 3 * static_cast<std::size_t>(triangle);
  return {data_.positions[index[0]], data_.positions[index[1]], data_.positions[index[2]]};
}

Vec3f TriangleMesh::vertex_normal(const Hit& hit) const {
  if (data_.normals.empty()) return {};
  const std::uint32_t* index = data_.indices.data() + 3 * static_cast<std::size_t>(hit.primitive);
  return side_ *
         ((1 - hit.u - hit.v) * data_.normals[index[0]] + hit.u * data_.normals[index[1]] + hit.v * data_.normals[index[2]]);
}

SurfacePoint TriangleMesh::surface_point(const Ray&, const Hit& hit) const {
  const auto [a, b, c] = corners(hit.primitive);
  const Vec3f e1 = b - a, e2 = c - a;
  SurfacePoint point;
  point.position = a + hit.u * e1 + hit.v * e2;
  point.geometric_normal = side_ * normalize(cross(e1, e2));
  point.shading_normal = point.geometric_normal;
  if (!data_.normals.empty()) {
    const std::uint32_t* index = data_.indices.data() + 3 * static_cast<std::size_t>(hit.primitive);
    const Vec3f n =
        (1 - hit.u - hit.v) * data_.normals[index[0]] + hit.u * data_.normals[index[1]] + hit.v * data_.normals[index[2]];
    const float squared = length_squared(n);
    if (squared > 0) point.shading_normal = (side_ / std::sqrt(squared)) * n;
  }
  return point;
}

Vec3f TriangleMesh::tangent(const SurfacePoint&, const Hit& hit) const {
  const auto [a, b, c] = corners(hit.primitive);
  const Vec3f e1 = b - a, e2 = c - a;
  if (data_.uvs.empty()) return normalize(e1);
  const std::uint32_t* index = data_.indices.data() + 3 * static_cast<std::size_t>(hit.primitive);
  const Vec2f uv0 = data_.uvs[index[0]], uv1 = data_.uvs[index[1]], uv2 = data_.uvs[index[2]];
  const float du1 = uv1.x - uv0.x, dv1 = uv1.y - uv0.y, du2 = uv2.x - uv0.x, dv2 = uv2.y - uv0.y;
  const float determinant = du1 * dv2 - dv1 * du2;
  const Vec3f d = (dv2 * e1 - dv1 * e2) * (determinant < 0 ? -1.0f : 1.0f);
  return determinant != 0 && length_squared(d) > 0 ? normalize(d) : normalize(e1);
}

Shape::UvDerivatives TriangleMesh::uv_derivatives(const SurfacePoint&, const Hit& hit) const {
  const auto [a, b, c] = corners(hit.primitive);
  const Vec3f e1 = b - a, e2 = c - a;
  if (data_.uvs.empty()) return {e1, e2};
  const std::uint32_t* index = data_.indices.data() + 3 * static_cast<std::size_t>(hit.primitive);
  const Vec2f uv0 = data_.uvs[index[0]], uv1 = data_.uvs[index[1]], uv2 = data_.uvs[index[2]];
  const float du1 = uv1.x - uv0.x, dv1 = uv1.y - uv0.y, du2 = uv2.x - uv0.x, dv2 = uv2.y - uv0.y;
  const float determinant = du1 * dv2 - dv1 * du2;
  if (determinant == 0) return {normalize(e1), normalize(e2)};  // no texture to speak of: all of it in a point or a line
  return {(dv2 * e1 - dv1 * e2) / determinant, (du1 * e2 - du2 * e1) / determinant};
}

Rgb TriangleMesh::vertex_color(const Hit& hit) const {
  if (data_.colors.empty()) return {};
  const std::uint32_t* index = data_.indices.data() + 3 * static_cast<std::size_t>(hit.primitive);
  return data_.colors[index[0]] * (1 - hit.u - hit.v) + data_.colors[index[1]] * hit.u + data_.colors[index[2]] * hit.v;
}

Vec2f TriangleMesh::uv(const SurfacePoint&, const Hit& hit) const {
  if (data_.uvs.empty()) return {hit.u, hit.v};
  const std::uint32_t* index = data_.indices.data() + 3 * static_cast<std::size_t>(hit.primitive);
  const Vec2f a = data_.uvs[index[0]], b = data_.uvs[index[1]], c = data_.uvs[index[2]];
  const float first = 1 - hit.u - hit.v;
  return {first * a.x + hit.u * b.x + hit.v * c.x, first * a.y + hit.u * b.y + hit.v * c.y};
}

std::optional<ShapeSample> TriangleMesh::sample(Vec3f reference, Vec2f u) const {
  const DiscreteDistribution::Choice choice = by_area_.sample(u.x);
  return sample_shared(static_cast<std::uint32_t>(choice.index), {choice.probability, 1 / area_}, reference, {choice.u, u.y});
}

AreaSample TriangleMesh::sample_area(Vec2f u) const {
  const DiscreteDistribution::Choice choice = by_area_.sample(u.x);
  return sample_triangle_area(static_cast<std::uint32_t>(choice.index), {choice.u, u.y});
}

AreaBounds TriangleMesh::area_bounds(const UnitBox& box) const {
  const DiscreteDistribution::Choice first = by_area_.sample(box.lower.x), last = by_area_.sample(box.last().x);
  if (first.index == last.index) {  // a piece of one triangle, whose edges are straight
    const auto triangle = static_cast<std::uint32_t>(first.index);
    std::vector<Vec3f> corners;
    for (const float x : {first.u, last.u}) {
      for (const float y : {box.lower.y, box.upper.y}) corners.push_back(sample_triangle_area(triangle, {x, y}).position);
    }
    return {ball_around(corners), {triangle_normal(triangle), 0}};
  }
  constexpr std::size_t kMany = 256;  // not worth the time
  if (last.index - first.index >= kMany) return {ball_, {}};
  std::vector<Vec3f> points, normals;
  for (std::size_t i = first.index; i <= last.index; ++i) {
    const auto triangle = static_cast<std::uint32_t>(i);
    if (!(triangle_area(triangle) > 0)) continue;
    const auto [a, b, c] = corners(triangle);
    points.insert(points.end(), {a, b, c});
    normals.push_back(triangle_normal(triangle));
  }
  return {ball_around(points), cone_around(normals)};
}

AreaSample TriangleMesh::sample_triangle_area(std::uint32_t triangle, Vec2f u) const {
  const auto [a, b, c] = corners(triangle);
  const float root = std::sqrt(u.x);
  return {a + root * (1 - u.y) * (b - a) + root * u.y * (c - a), triangle_normal(triangle)};
}

std::optional<ShapeSample> TriangleMesh::sample_triangle(std::uint32_t triangle, Vec3f reference, Vec2f u) const {
  return sample_shared(triangle, {1, 1 / triangle_area(triangle)}, reference, u);
}

std::optional<ShapeSample> TriangleMesh::sample_shared(std::uint32_t triangle, Share share, Vec3f reference, Vec2f u) const {
  const auto [a, b, c] = corners(triangle);
  const Vec3f cross_product = cross(b - a, c - a);
  const float twice_area = length(cross_product);
  const Vec3f normal = cross_product * (side_ / twice_area);
  if (looks_large(0.5f * twice_area, (a + b + c) / 3, normal, reference)) {
    const SphericalTriangle seen(a, b, c, reference);
    const Vec3f wi = seen.sample(u);
    const float distance = dot(a - reference, normal) / dot(wi, normal);
    if (!(distance > 0)) return std::nullopt;
    return ShapeSample{reference + distance * wi, normal, wi, distance, share.probability / seen.solid_angle(), triangle};
  }
  const float root = std::sqrt(u.x);
  const Vec3f position = a + root * (1 - u.y) * (b - a) + root * u.y * (c - a);
  const Vec3f d = position - reference;
  const float distance = length(d);
  if (!(distance > 0)) return std::nullopt;
  const Vec3f wi = d / distance;
  const float pdf_solid_angle = to_solid_angle(share.pdf_area, distance, dot(normal, wi));
  if (!(pdf_solid_angle > 0)) return std::nullopt;
  return ShapeSample{position, normal, wi, distance, pdf_solid_angle, triangle};
}

float TriangleMesh::pdf(Vec3f reference, const SurfacePoint& point, std::uint32_t primitive, Vec3f wi, float distance) const {
  return shared_pdf(primitive, {by_area_.probability(primitive), 1 / area_}, reference, point, wi, distance);
}

float TriangleMesh::triangle_pdf(std::uint32_t triangle, Vec3f reference, const SurfacePoint& point, Vec3f wi,
                                 float distance) const {
  return shared_pdf(triangle, {1, 1 / triangle_area(triangle)}, reference, point, wi, distance);
}

float TriangleMesh::shared_pdf(std::uint32_t triangle, Share share, Vec3f reference, const SurfacePoint& point, Vec3f wi,
                               float distance) const {
  const auto [a, b, c] = corners(triangle);
  const float area = 0.5f * length(cross(b - a, c - a));
  if (looks_large(area, (a + b + c) / 3, point.geometric_normal, reference)) {
    return share.probability / SphericalTriangle(a, b, c, reference).solid_angle();
  }
  return to_solid_angle(share.pdf_area, distance, dot(point.geometric_normal, wi));
}

float TriangleMesh::triangle_area(std::uint32_t triangle) const {
  const auto [a, b, c] = corners(triangle);
  return 0.5f * length(cross(b - a, c - a));
}

Vec3f TriangleMesh::triangle_normal(std::uint32_t triangle) const {
  const auto [a, b, c] = corners(triangle);
  return side_ * normalize(cross(b - a, c - a));
}

Bounds TriangleMesh::bounds() const {
  Bounds result;
  for (const Vec3f& p : data_.positions) result.extend(p);
  return result;
}

}  // namespace fluxfarm
