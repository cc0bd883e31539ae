// Gives a one-sided surface a back: the side of wo decides which of two BSDFs is asked, in a frame whose z is on that side.
#include "materials/bsdf_factories.h"
#include "materials/nested.h"
#include "materials/textured_factories.h"

namespace fluxfarm {
namespace {

// Multiplying by a sign costs less than a branch: which side a path meets cannot be guessed.
float side_of(const Vec3f& wo) { return wo.z > 0 ? 1.0f : -1.0f; }
Vec3f on_side(const Vec3f& w, float side) { return {w.x, w.y, side * w.z}; }

class Twosided final : public Bsdf {
 public:
  Twosided(const Bsdf& front, const Bsdf& back) : sides_{&front, &back} {}

  BsdfValue value(const Vec3f& wo, const Vec3f& wi) const override {
    const float side = side_of(wo);
    return asked(wo).value(on_side(wo, side), on_side(wi, side));
  }

  std::optional<BsdfSample> sample(const Vec3f& wo, float u_lobe, Vec2f u) const override {
    const float side = side_of(wo);
    std::optional<BsdfSample> s = asked(wo).sample(on_side(wo, side), u_lobe, u);
    if (s) s->wi.z *= side;
    return s;
  }

  Rgb albedo(const Vec3f& wo) const override { return asked(wo).albedo(on_side(wo, side_of(wo))); }
  bool has_continuous_lobe() const override { return sides_[0]->has_continuous_lobe() || sides_[1]->has_continuous_lobe(); }
  Sides sides() const override { return {sides_[0], sides_[1]}; }
  bool chooses_lobe() const override { return sides_[0]->chooses_lobe() || sides_[1]->chooses_lobe(); }

 private:
  const Bsdf& asked(const Vec3f& wo) const { return *sides_[wo.z > 0 ? 0 : 1]; }

  const Bsdf* sides_[2];  // front, back
};

// Within another material; one that belongs to a surface is asked by its sides.
class TexturedTwosided final : public TexturedMaterial {
 public:
  TexturedTwosided(NestedMaterial front, NestedMaterial back) : front_(front), back_(back) {}

  const Bsdf& add_to(BsdfSpace& space, const MaterialPoint& point) const override {
    const Bsdf& front = front_.at(point, space);
    const Bsdf& back = back_.at(point, space);
    return space.make<Twosided>(front, back);
  }

 private:
  NestedMaterial front_, back_;
};

}  // namespace

std::unique_ptr<TexturedMaterial> make_textured_twosided(NestedMaterial front, NestedMaterial back) {
  return std::make_unique<TexturedTwosided>(front, back);
}

std::unique_ptr<Bsdf> make_twosided(const Bsdf& front, const Bsdf& back) { return std::make_unique<Twosided>(front, back); }

}  // namespace fluxfarm
