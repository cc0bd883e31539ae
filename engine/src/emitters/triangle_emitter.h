// One triangle of an emitting mesh: where there are many emitters, each is chosen by itself.
#pragma once

#include "emitters/emitter.h"
#include "geometry/triangle_mesh.h"

namespace fluxfarm {

class TriangleEmitter final : public Emitter {
 public:
  // Emits `radiance` (W m^-2 sr^-1) from the front side of a triangle of `mesh`, or from both; `mesh` must outlive this.
  TriangleEmitter(const TriangleMesh& mesh, std::uint32_t triangle, Rgb radiance, bool both_sides)
      : mesh_(&mesh), triangle_(triangle), both_sides_(both_sides), radiance_(radiance) {}

  std::optional<EmitterSample> sample(Vec3f reference, Vec2f u) const override {
    return emitted_from(mesh_->sample_triangle(triangle_, reference, u), radiance_, both_sides_);
  }
  // Never called: particles leave the mesh as a whole.
  std::optional<EmissionSample> emit(Vec2f, Vec2f, Vec3f) const override;
  EmissionBounds emission_bounds(const EmissionCell& cell, Vec3f scene_center) const override;
  Rgb power() const override { return radiance_ * ((both_sides_ ? kTwoPi : kPi) * mesh_->triangle_area(triangle_)); }
  // Of the mesh: that of all that it stands for.
  float area() const override { return mesh_->area(); }
  std::optional<EmitterBounds> bounds() const override;

 private:
  const TriangleMesh* mesh_;
  std::uint32_t triangle_;
  bool both_sides_;
  Rgb radiance_;
};

}  // namespace fluxfarm
