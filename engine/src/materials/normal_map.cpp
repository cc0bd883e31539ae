// Shading normals from a texture: rgb is (n + 1) / 2, with n in the frame of the surface, x along increasing u.
#include "materials/nested.h"
#include "materials/perturbed.h"
#include "materials/textured_factories.h"

namespace fluxfarm {
namespace {

class NormalMap final : public TexturedMaterial {
 public:
  NormalMap(NestedMaterial nested, const Texture& normals) : nested_(nested), normals_(normals) {}

  const Bsdf& add_to(BsdfSpace& space, const MaterialPoint& point) const override {
    const Bsdf& nested = nested_.at(point, space);
    const Rgb colour = normals_.value(point.texture);
    const Vec3f n{2 * colour.r - 1, 2 * colour.g - 1, 2 * colour.b - 1};
    const float squared = length_squared(n);
    return space.make<PerturbedBsdf>(nested, squared > 0 ? tilted_frame(n / std::sqrt(squared)) : Frame());
  }

 private:
  NestedMaterial nested_;
  const Texture& normals_;
};

}  // namespace

std::unique_ptr<TexturedMaterial> make_normal_map(NestedMaterial nested, const Texture& normals) {
  return std::make_unique<NormalMap>(nested, normals);
}

}  // namespace fluxfarm
