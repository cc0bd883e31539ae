// Shading normals of a surface that a texture lifts: height is scale times the texture's luminance, m.
//
// [Blinn78] J. Blinn, "Simulation of Wrinkled Surfaces", SIGGRAPH 1978: the height's gradient alone, not its amount, and without
// the derivatives of the normal.
#include "materials/nested.h"
#include "materials/perturbed.h"
#include "materials/textured_factories.h"

namespace fluxfarm {
namespace {

class BumpMap final : public TexturedMaterial {
 public:
  BumpMap(NestedMaterial nested, const Texture& height, float scale) : nested_(nested), height_(height), scale_(scale) {}

  const Bsdf& add_to(BsdfSpace& space, const MaterialPoint& point) const override {
    const Bsdf& nested = nested_.at(point, space);
    const Vec2f slope = height_.luminance_gradient(point.texture.uv);
    // The tangents of the lifted surface in the frame of the shading normal.                                   [Blinn78]
    const Vec3f du{point.dp_du.x, point.dp_du.y, scale_ * slope.x}, dv{point.dp_dv.x, point.dp_dv.y, scale_ * slope.y};
    Vec3f n = cross(du, dv);
    const float squared = length_squared(n);
    if (!(squared > 0)) return space.make<PerturbedBsdf>(nested, Frame());
    n *= 1 / std::sqrt(squared);
    return space.make<PerturbedBsdf>(nested, tilted_frame(dot(n, point.geometric_normal) < 0 ? -n : n));
  }

 private:
  NestedMaterial nested_;
  const Texture& height_;
  float scale_;
};

}  // namespace

std::unique_ptr<TexturedMaterial> make_bump_map(NestedMaterial nested, const Texture& height, float scale) {
  return std::make_unique<BumpMap>(nested, height, scale);
}

}  // namespace fluxfarm
