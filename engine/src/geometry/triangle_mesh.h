// Indexed triangle mesh. As a light: a triangle by area, then a point of it by solid angle where the triangle looks large, else by
// area.
#pragma once

#include <vector>

#include "geometry/shape.h"
#include "sampling/discrete_distribution.h"

namespace fluxfarm {

class TriangleMesh final : public Shape {
 public:
  struct Data {
    std::vector<Vec3f> positions;        // world, m
    std::vector<Vec3f> normals;          // per vertex, unit; or empty: flat
    std::vector<Vec2f> uvs;              // per vertex; or empty
    std::vector<std::uint32_t> indices;  // three per triangle, counter-clockwise seen from the front
    std::vector<Rgb> colors{};           // per vertex; or empty
  };
  // `flipped` swaps front and back. `emissive` builds the tables that sample() and pdf() need.
  TriangleMesh(Data data, bool flipped, bool emissive);

  SurfacePoint surface_point(const Ray& ray, const Hit& hit) const override;
  Vec3f tangent(const SurfacePoint& point, const Hit& hit) const override;
  // Those of the vertices, between them; the barycentric weights of the second and third vertex if there are none.
  UvDerivatives uv_derivatives(const SurfacePoint& point, const Hit& hit) const override;
  Vec2f uv(const SurfacePoint& point, const Hit& hit) const override;
  Rgb vertex_color(const Hit& hit) const override;
  std::optional<ShapeSample> sample(Vec3f reference, Vec2f u) const override;
  float pdf(Vec3f reference, const SurfacePoint& point, std::uint32_t primitive, Vec3f wi, float distance) const override;
  AreaSample sample_area(Vec2f u) const override;
  AreaBounds area_bounds(const UnitBox& box) const override;
  float area() const override { return area_; }
  Bounds bounds() const override;

  // One triangle as a light of its own: as sample() and pdf() of a mesh of nothing else.
  std::optional<ShapeSample> sample_triangle(std::uint32_t triangle, Vec3f reference, Vec2f u) const;
  float triangle_pdf(std::uint32_t triangle, Vec3f reference, const SurfacePoint& point, Vec3f wi, float distance) const;

  AreaSample sample_triangle_area(std::uint32_t triangle, Vec2f u) const;

  struct Corners {
    Vec3f a, b, c;
  };
  Corners corners(std::uint32_t triangle) const;
  // Interpolated normal of the vertices on the front side, not normalised; 0 0 0 without any.
  Vec3f vertex_normal(const Hit& hit) const;
  float triangle_area(std::uint32_t triangle) const;    // m^2
  Vec3f triangle_normal(std::uint32_t triangle) const;  // unit, front side

  const Data& data() const { return data_; }
  std::size_t triangles() const { return data_.indices.size() / 3; }
  bool flipped() const { return side_ < 0; }

 private:
  // How probable a triangle is, and the density of its points, m^-2.
  struct Share {
    float probability, pdf_area;
  };
  std::optional<ShapeSample> sample_shared(std::uint32_t triangle, Share share, Vec3f reference, Vec2f u) const;
  float shared_pdf(std::uint32_t triangle, Share share, Vec3f reference, const SurfacePoint& point, Vec3f wi, float distance) const;

  Data data_;
  float side_;  // -1 when flipped
  float area_ = 0;
  DiscreteDistribution by_area_;
  Ball ball_;  // around all of it, where it emits
};

}  // namespace fluxfarm
