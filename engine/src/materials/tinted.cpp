// Every BSDF but the plastics is linear in its colours, and samples the same directions whatever they are: f = colour * f(white).
#include "materials/tinted.h"

namespace fluxfarm {
namespace {

// Parts of the base, for the albedo of one that transmits.
struct Parts {
  std::unique_ptr<Bsdf> reflecting, transmitting;
};

class TintedBsdf final : public Bsdf {
 public:
  TintedBsdf(const Bsdf& base, const Parts& parts, Rgb reflected, Rgb transmitted)
      : base_(base), parts_(parts), reflected_(reflected), transmitted_(transmitted) {}

  BsdfValue value(const Vec3f& wo, const Vec3f& wi) const override {
    BsdfValue v = base_.value(wo, wi);
    v.f *= tint(wo, wi);
    return v;
  }

  std::optional<BsdfSample> sample(const Vec3f& wo, float u_lobe, Vec2f u) const override {
    std::optional<BsdfSample> s = base_.sample(wo, u_lobe, u);
    if (s) s->weight *= tint(wo, s->wi);
    return s;
  }

  Rgb albedo(const Vec3f& wo) const override {
    if (!parts_.reflecting) return reflected_ * base_.albedo(wo);
    return reflected_ * parts_.reflecting->albedo(wo) + transmitted_ * parts_.transmitting->albedo(wo);
  }
  bool has_continuous_lobe() const override { return base_.has_continuous_lobe(); }
  bool chooses_lobe() const override { return base_.chooses_lobe(); }
  bool transmits() const override { return base_.transmits(); }

 private:
  Rgb tint(const Vec3f& wo, const Vec3f& wi) const { return (wo.z > 0) == (wi.z > 0) ? reflected_ : transmitted_; }

  const Bsdf& base_;
  const Parts& parts_;
  Rgb reflected_, transmitted_;
};

class TintedMaterial final : public TexturedMaterial {
 public:
  TintedMaterial(const TintedDescription& d, Parts parts) : d_(d), parts_(std::move(parts)) {}

  const Bsdf& add_to(BsdfSpace& space, const MaterialPoint& point) const override {
    return space.make<TintedBsdf>(*d_.base, parts_, colour(d_.reflected, point.texture), colour(d_.transmitted, point.texture));
  }

 private:
  static Rgb colour(const Texture* texture, const TexturePoint& point) {
    return texture != nullptr ? texture->value(point) : Rgb{1.0f};
  }

  TintedDescription d_;
  Parts parts_;
};

}  // namespace

std::unique_ptr<TexturedMaterial> make_tinted(const TintedDescription& description, std::unique_ptr<Bsdf> reflecting_part,
                                              std::unique_ptr<Bsdf> transmitting_part) {
  return std::make_unique<TintedMaterial>(description, Parts{std::move(reflecting_part), std::move(transmitting_part)});
}

}  // namespace fluxfarm
