// Shading normals from a texture: rgb is (n + 1) / 2, with n in the frame of the surface, x along increasing u.
#include "materials/nested.h"
#include "materials/perturbed.h"
#include "materials/textured_factories.h"

namespace fluxfarm {
namespace {

class NormalMap final : public TexturedMaterial {
 public:
  NormalMap(NestedMaterial nested, const Texture& normals, const NormalMapDescription& d)
      : nested_(nested), normals_(normals), scale_(d.scale), y_against_v_(d.y_against_v) {}

  const Bsdf& add_to(BsdfSpace& space, const MaterialPoint& point) const override {
    const Bsdf& nested = nested_.at(point, space);
    const Rgb colour = normals_.value(point.texture);
    const float x = (2 * colour.r - 1) * scale_, y = (2 * colour.g - 1) * scale_;
    const Vec3f n{x, y_against_v_ && t_runs_along_v(point) ? -y : y, 2 * colour.b - 1};
    const float squared = length_squared(n);
    return space.make<PerturbedBsdf>(nested, squared > 0 ? tilted_frame(n / std::sqrt(squared)) : Frame());
  }

 private:
  // Whether t, across s (increasing u) and the normal, is on the side of increasing v.
  static bool t_runs_along_v(const MaterialPoint& point) {
    return point.dp_du.x * point.dp_dv.y - point.dp_du.y * point.dp_dv.x > 0;
  }

  NestedMaterial nested_;
  const Texture& normals_;
  float scale_;
  bool y_against_v_;
};

}  // namespace

std::unique_ptr<TexturedMaterial> make_normal_map(NestedMaterial nested, const Texture& normals, const NormalMapDescription& d) {
  return std::make_unique<NormalMap>(nested, normals, d);
}

}  // namespace fluxfarm
