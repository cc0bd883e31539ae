// Two BSDFs side by side, too finely mixed to be told apart: (1 - weight) of the first and weight of the second.
#include "materials/bsdf_factories.h"
#include "materials/directions.h"
#include "materials/nested.h"
#include "materials/textured_factories.h"

namespace fluxfarm {
namespace {

class Blend final : public Bsdf {
 public:
  Blend(const Bsdf& first, const Bsdf& second, float weight) : first_(first), second_(second), weight_(weight) {}

  BsdfValue value(const Vec3f& wo, const Vec3f& wi) const override {
    const BsdfValue a = first_.value(wo, wi), b = second_.value(wo, wi);
    return {a.f * (1 - weight_) + b.f * weight_, a.pdf * (1 - weight_) + b.pdf * weight_};
  }

  std::optional<BsdfSample> sample(const Vec3f& wo, float u_lobe, Vec2f u) const override {
    const bool second = u_lobe < weight_;
    const float u_rest = second ? u_lobe / weight_ : (u_lobe - weight_) / (1 - weight_);
    std::optional<BsdfSample> s = (second ? second_ : first_).sample(wo, below_one(u_rest), u);
    if (!s || s->delta) return s;  // the probability of the choice is the weight of a delta lobe
    const BsdfValue v = value(wo, s->wi);
    if (!(v.pdf > 0)) return std::nullopt;
    s->pdf = v.pdf;
    s->weight = v.f * (std::abs(s->wi.z) / v.pdf);
    return s;
  }

  Rgb albedo(const Vec3f& wo) const override { return first_.albedo(wo) * (1 - weight_) + second_.albedo(wo) * weight_; }
  bool has_continuous_lobe() const override { return first_.has_continuous_lobe() || second_.has_continuous_lobe(); }
  bool transmits() const override { return first_.transmits() || second_.transmits(); }

 private:
  const Bsdf& first_;
  const Bsdf& second_;
  float weight_;
};

class TexturedBlend final : public TexturedMaterial {
 public:
  TexturedBlend(NestedMaterial first, NestedMaterial second, TexturedScalar weight)
      : first_(first), second_(second), weight_(weight) {}

  const Bsdf& add_to(BsdfSpace& space, const MaterialPoint& point) const override {
    const Bsdf& first = first_.at(point, space);
    const Bsdf& second = second_.at(point, space);
    return space.make<Blend>(first, second, weight_.at(point));
  }

 private:
  NestedMaterial first_, second_;
  TexturedScalar weight_;
};

}  // namespace

std::unique_ptr<Bsdf> make_blend(const Bsdf& first, const Bsdf& second, float weight) {
  return std::make_unique<Blend>(first, second, weight);
}

std::unique_ptr<TexturedMaterial> make_textured_blend(NestedMaterial first, NestedMaterial second, TexturedScalar weight) {
  return std::make_unique<TexturedBlend>(first, second, weight);
}

}  // namespace fluxfarm
