// One triangle of an emitting mesh: where there are many emitters, each is chosen by itself.
#pragma once

#include "emitters/emitter.h"
#include "geometry/triangle_mesh.h"

namespace fluxfarm {

class TriangleEmitter final : public Emitter {
 public:
  // Emits `radiance` (W m^-2 sr^-1) from the front side of a triangle of `mesh`, which must outlive this.
  TriangleEmitter(const TriangleMesh& mesh, std::uint32_t triangle, Rgb radiance)
      : mesh_(&mesh), triangle_(triangle), radiance_(radiance) {}

  std::optional<EmitterSample> sample(Vec3f reference, Vec2f u) const override {
    return emitted_from(mesh_->sample_triangle(triangle_, reference, u), radiance_);
  }
  Rgb power() const override { return radiance_ * (kPi * mesh_->triangle_area(triangle_)); }
  std::optional<EmitterBounds> bounds() const override;

 private:
  const TriangleMesh* mesh_;
  std::uint32_t triangle_;
  Rgb radiance_;
};

}  // namespace fluxfarm
