// Covers part of a surface, at random: with probability `opacity` light meets the nested BSDF, else it passes straight on.
//
// Next-event estimation takes the surface as opaque; light behind it is found by the paths that pass, which count it in full. That
// is unbiased, if noisy for small lights, except for lights that no path can meet: points and directions do not shine through.
#include "materials/bsdf_factories.h"
#include "materials/directions.h"
#include "materials/nested.h"
#include "materials/textured_factories.h"

namespace fluxfarm {
namespace {

// Interpolation and luminance of texels that lie exactly at the cut-off may round below it.
constexpr float kRounding = 1e-6f;

float covered_share(float opacity, std::optional<float> cutoff) {
  if (!cutoff) return opacity;
  return opacity >= *cutoff - kRounding ? 1.0f : 0.0f;
}

class Mask final : public Bsdf {
 public:
  Mask(const Bsdf& covered, float opacity) : covered_(covered), opacity_(opacity) {}

  BsdfValue value(const Vec3f& wo, const Vec3f& wi) const override {
    const BsdfValue v = covered_.value(wo, wi);
    return {v.f * opacity_, v.pdf * opacity_};
  }

  std::optional<BsdfSample> sample(const Vec3f& wo, float u_lobe, Vec2f u) const override {
    if (u_lobe >= opacity_) return pass(wo);
    std::optional<BsdfSample> s = covered_.sample(wo, below_one(u_lobe / opacity_), u);
    if (s) s->pdf *= opacity_;
    return s;
  }

  Rgb albedo(const Vec3f& wo) const override { return covered_.albedo(wo) * opacity_ + Rgb{1 - opacity_}; }
  bool has_continuous_lobe() const override { return covered_.has_continuous_lobe(); }
  bool transmits() const override { return true; }

 private:
  const Bsdf& covered_;
  float opacity_;
};

class TexturedMask final : public TexturedMaterial {
 public:
  TexturedMask(NestedMaterial covered, TexturedScalar opacity, std::optional<float> cutoff)
      : covered_(covered), opacity_(opacity), cutoff_(cutoff) {}

  const Bsdf& add_to(BsdfSpace& space, const MaterialPoint& point) const override {
    const Bsdf& covered = covered_.at(point, space);
    return space.make<Mask>(covered, covered_share(opacity_.at(point), cutoff_));
  }

 private:
  NestedMaterial covered_;
  TexturedScalar opacity_;
  std::optional<float> cutoff_;
};

}  // namespace

std::unique_ptr<Bsdf> make_mask(const Bsdf& covered, float opacity, std::optional<float> cutoff) {
  return std::make_unique<Mask>(covered, covered_share(opacity, cutoff));
}

std::unique_ptr<TexturedMaterial> make_textured_mask(NestedMaterial covered, TexturedScalar opacity, std::optional<float> cutoff) {
  return std::make_unique<TexturedMask>(covered, opacity, cutoff);
}

}  // namespace fluxfarm
