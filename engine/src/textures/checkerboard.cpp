// Squares of two colours, as Mitsuba's `checkerboard`. As a roughness Mitsuba 3.6 swaps the two; here they stay.
#include "textures/texture_factories.h"
#include "textures/uv_map.h"

namespace fluxfarm {
namespace {

class Checkerboard final : public Texture {
 public:
  explicit Checkerboard(const CheckerboardDescription& d) : color0_(d.color0), color1_(d.color1), to_uv_(d.to_uv) {}

  Rgb value(const TexturePoint& point) const override {
    const Vec2f p = to_uv_(point.uv);
    return (fraction(p.x) > 0.5f) == (fraction(p.y) > 0.5f) ? color0_ : color1_;
  }
  Rgb mean_value() const override { return (color0_ + color1_) * 0.5f; }

 private:
  Rgb color0_, color1_;
  UvMap to_uv_;
};

}  // namespace

std::unique_ptr<Texture> make_checkerboard(const CheckerboardDescription& d) { return std::make_unique<Checkerboard>(d); }

}  // namespace fluxfarm
