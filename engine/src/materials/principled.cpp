// One material for most surfaces: diffuse, metal, coat, cloth and glass, blended by parameters between 0 and 1. Semantics of
// Mitsuba 3's `principled`. The back scatters only where light is transmitted.
//
// Lobes: diffuse (with retro-reflection, flattening, sheen), clear coat, and the main microfacet lobe, which reflects and refracts.
// The lobe is chosen by an estimate of what each returns, so a dark or matt surface wastes few samples on its gloss; Mitsuba's
// sampling rates therefore have no counterpart. The value is the same, the density is our own.
//
// [Burley12] B. Burley, "Physically-Based Shading at Disney", SIGGRAPH 2012 course notes.
// [Burley15] B. Burley, "Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering", SIGGRAPH 2015 course notes.
// [Walter07] B. Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007.
#include "materials/albedo_table.h"
#include "materials/bsdf_factories.h"
#include "materials/directions.h"
#include "materials/ggx.h"
#include "materials/gtr1.h"
#include "materials/principled_terms.h"
#include "materials/textured_factories.h"

namespace fluxfarm {
namespace {

Ggx main_distribution(const PrincipledParameters& p) {
  constexpr float kSmallest = 0.001f;
  const float aspect = std::sqrt(1 - 0.9f * p.anisotropic), alpha = p.roughness * p.roughness;  // [Burley12, section 5.4]
  return {std::max(alpha / aspect, kSmallest), std::max(alpha * aspect, kSmallest)};
}

Gtr1 coat_distribution(const PrincipledParameters& p) { return Gtr1(mix(0.1f, 0.001f, p.clearcoat_gloss)); }
float coat_fresnel(const PrincipledParameters& p, float cos) { return mix(0.04f, 1.0f, schlick_weight_into(cos, p.eta)); }

// All but the albedo.
class PrincipledLobes : public Bsdf {
 public:
  // `transmits`: of the material, here or at other places.
  PrincipledLobes(const PrincipledParameters& p, bool transmits)
      : p_(p),
        distribution_(main_distribution(p)),
        opaque_((1 - p.metallic) * (1 - p.spec_trans)),
        clear_((1 - p.metallic) * p.spec_trans),
        transmits_(transmits) {}

  BsdfValue value(const Vec3f& wo, const Vec3f& wi) const override {
    const bool front = wo.z > 0, reflection = front == (wi.z > 0);
    if (wo.z == 0 || wi.z == 0 || (clear_ == 0 && (!front || !reflection))) return {};
    const float eta = front ? p_.eta : 1 / p_.eta;
    const std::optional<Vec3f> m = half_vector(wo, wi, reflection ? 1 : eta);
    if (!m) return {};
    const float cos_o = dot(wo, *m), cos_i = dot(wi, *m);
    // Both directions must see the side of the microfacet that they see of the surface.
    if (cos_o * wo.z <= 0 || cos_i * wi.z <= 0) return {};
    const LobeChoice choice = choose(wo);
    BsdfValue result = main_lobe(wo, wi, *m, cos_o, cos_i, eta, reflection);
    result.pdf *= choice.main;
    if (front && reflection) add_diffuse_and_coat(wo, wi, *m, cos_o, choice, result);
    return result;
  }

  std::optional<BsdfSample> sample(const Vec3f& wo, float u_lobe, Vec2f u) const override {
    if (wo.z == 0 || (wo.z < 0 && clear_ == 0)) return std::nullopt;
    const LobeChoice choice = choose(wo);
    Vec3f wi;
    float eta = 1;
    if (u_lobe < choice.diffuse) {
      wi = square_to_cosine_hemisphere(u);
    } else if (u_lobe < choice.diffuse + choice.coat) {
      const Vec3f m = coat_distribution(p_).sample_normal(u);
      wi = reflect(wo, m, dot(wo, m));
    } else {
      if (!(choice.main > 0)) return std::nullopt;
      const float u_rest = std::max((u_lobe - choice.diffuse - choice.coat) / choice.main, 0.0f);
      wi = sample_main(wo, u_rest, u, eta);
    }
    if ((wo.z > 0) != ((wi.z > 0) == (eta == 1))) return std::nullopt;  // reflection stays on its side, refraction does not
    const BsdfValue v = value(wo, wi);
    if (!(v.pdf > 0)) return std::nullopt;
    return BsdfSample{.wi = wi, .weight = v.f * (std::abs(wi.z) / v.pdf), .pdf = v.pdf, .eta = eta};
  }

  bool has_continuous_lobe() const override { return true; }
  bool transmits() const override { return transmits_; }

 protected:
  // Rough estimate of the light of each lobe; dimensionless.
  struct LobeLight {
    Rgb diffuse, main;
    float coat = 0;
  };
  LobeLight estimate(const Vec3f& wo) const {
    LobeLight light;
    const float dielectric = fresnel_dielectric(wo.z, p_.eta).reflectance;
    if (wo.z < 0) {
      light.main = (Rgb{dielectric} + sqrt_base() * (1 - dielectric)) * clear_;
      return light;
    }
    light.diffuse = p_.base_color * opaque_;
    // The mean of the sheen over the hemisphere is below a tenth except at grazing angles.
    if (opaque_ > 0) light.diffuse += Rgb{p_.sheen * (1 - p_.metallic) * mix(0.1f, 0.5f, schlick_weight(wo.z))};
    light.main = principled_fresnel(p_, dielectric, wo.z) + sqrt_base() * (clear_ * (1 - dielectric));
    if (p_.clearcoat > 0) light.coat = p_.clearcoat * coat_fresnel(p_, wo.z) * wo.z;
    return light;
  }

  PrincipledParameters p_;

 private:
  // Probabilities; they sum to one unless nothing is scattered.
  struct LobeChoice {
    float diffuse = 0, coat = 0, main = 0;
  };
  LobeChoice choose(const Vec3f& wo) const {
    const LobeLight light = estimate(wo);
    const float diffuse = max_component(light.diffuse), main = max_component(light.main), sum = diffuse + main + light.coat;
    if (!(sum > 0)) return {};
    return {diffuse / sum, light.coat / sum, main / sum};
  }

  Rgb sqrt_base() const { return {std::sqrt(p_.base_color.r), std::sqrt(p_.base_color.g), std::sqrt(p_.base_color.b)}; }

  // Of a microfacet: what it reflects, what it lets through, and the probability with which sample() refracts there.
  struct Interface {
    Rgb reflected;
    float transmitted = 0;
    float refracts = 0;
    DielectricFresnel fresnel;
  };
  Interface interface_at(float cos_o, bool front) const {
    Interface result;
    result.fresnel = fresnel_dielectric(cos_o, p_.eta);
    const float f = result.fresnel.reflectance;
    result.transmitted = clear_ * (1 - f);
    result.reflected = front ? principled_fresnel(p_, f, cos_o) : Rgb{clear_ * f};
    const float sum = max_component(result.reflected) + result.transmitted;
    if (result.transmitted > 0) result.refracts = result.transmitted / sum;
    return result;
  }

  // Reflection and refraction of the main lobe; pdf as if it were the only one.                                [Walter07]
  BsdfValue main_lobe(const Vec3f& wo, const Vec3f& wi, Vec3f m, float cos_o, float cos_i, float eta, bool reflection) const {
    const float d = distribution_.normal_density(m);
    const float visible = distribution_.visible_by_cosine(wo);
    const float g = distribution_.masking_by_cosine(wo) * distribution_.masking_by_cosine(wi);
    const Interface at = interface_at(cos_o, wo.z > 0);
    if (reflection) return {at.reflected * (0.25f * d * g), (1 - at.refracts) * 0.25f * d * visible};
    if (at.transmitted == 0) return {};
    const float root = cos_o + eta * cos_i;
    const float jacobian = d * std::abs(cos_o * cos_i) / (root * root);
    if (!(jacobian <= 1e30f)) return {};
    return {sqrt_base() * (at.transmitted * jacobian * g), at.refracts * jacobian * visible * eta * eta};
  }

  void add_diffuse_and_coat(const Vec3f& wo, const Vec3f& wi, Vec3f m, float cos_d, const LobeChoice& choice,
                            BsdfValue& result) const {
    if (opaque_ > 0) {
      result.f += p_.base_color * (opaque_ * kInvPi * principled_diffuse(p_, wo.z, wi.z, cos_d));
      if (p_.sheen > 0) result.f += principled_sheen(p_, cos_d);
      result.pdf += choice.diffuse * wi.z * kInvPi;
    }
    if (p_.clearcoat > 0) {
      // A fixed roughness of 0.25 masks and, unlike a microfacet BRDF, nothing divides by the cosines.           [Burley12]
      static const Ggx masking(0.25f, 0.25f);
      const float d = coat_distribution(p_).normal_density(m);
      const float g = masking.masking_by_cosine(wo) * wo.z * masking.masking_by_cosine(wi) * wi.z;
      result.f += Rgb{0.25f * p_.clearcoat * coat_fresnel(p_, cos_d) * d * g};
      result.pdf += choice.coat * d * m.z / (4 * cos_d);
    }
  }

  // A direction of the main lobe. `eta` becomes that of the refraction, 1 for a reflection; an impossible one ends on the wrong
  // side.
  Vec3f sample_main(const Vec3f& wo, float u_interface, Vec2f u, float& eta) const {
    const Vec3f m = distribution_.sample_normal(wo.z > 0 ? wo : -wo, u);
    const float cos_o = dot(wo, m);
    const Interface at = interface_at(cos_o, wo.z > 0);
    if (u_interface >= at.refracts) return reflect(wo, m, cos_o);
    eta = at.fresnel.eta;
    return refract(wo, m, cos_o, at.fresnel.cos_t, eta);
  }

  Ggx distribution_;
  float opaque_, clear_;  // weights of the diffuse and of the transmitting part
  bool transmits_;
};

class Principled final : public PrincipledLobes {
 public:
  explicit Principled(const PrincipledParameters& p)
      : PrincipledLobes(p, p.spec_trans > 0), front_(*this), back_(*this, AlbedoTable::Side::kBack) {}

  Rgb albedo(const Vec3f& wo) const override { return wo.z > 0 ? front_(wo.z) : back_(-wo.z); }

 private:
  AlbedoTable front_, back_;  // built by sampling the base class
};

// At a hit. The albedo is the estimate by which lobes are chosen.
class PrincipledAtHit final : public PrincipledLobes {
 public:
  using PrincipledLobes::PrincipledLobes;

  Rgb albedo(const Vec3f& wo) const override {
    if (wo.z == 0) return {};
    const LobeLight light = estimate(wo);
    const Rgb sum = light.diffuse + light.main + Rgb{light.coat};
    return {std::min(sum.r, 1.0f), std::min(sum.g, 1.0f), std::min(sum.b, 1.0f)};
  }
};

PrincipledParameters constant_parameters(const PrincipledDescription& d) {
  const bool vanishes = d.spec_trans.factor > 0 && d.eta == 1;  // no interface refracts without a contrast; as Mitsuba does
  return {.base_color = d.base_color,
          .roughness = d.roughness.factor,
          .anisotropic = d.anisotropic.factor,
          .metallic = d.metallic.factor,
          .spec_trans = d.spec_trans.factor,
          .spec_tint = d.spec_tint.factor,
          .sheen = d.sheen.factor,
          .sheen_tint = d.sheen_tint.factor,
          .flatness = d.flatness.factor,
          .clearcoat = d.clearcoat.factor,
          .clearcoat_gloss = d.clearcoat_gloss.factor,
          .eta = vanishes ? 1.001f : d.eta};
}

class TexturedPrincipled final : public TexturedMaterial {
 public:
  TexturedPrincipled(const PrincipledDescription& d, const Textures& textures)
      : constant_(constant_parameters(d)),
        transmits_(d.spec_trans.factor > 0),
        colour_(texture_of(textures, d.base_color_texture)) {
    using P = PrincipledParameters;
    const std::pair<const ScalarParameter&, float P::*> scalars[] = {
        {d.roughness, &P::roughness},   {d.anisotropic, &P::anisotropic},
        {d.metallic, &P::metallic},     {d.spec_trans, &P::spec_trans},
        {d.spec_tint, &P::spec_tint},   {d.sheen, &P::sheen},
        {d.sheen_tint, &P::sheen_tint}, {d.flatness, &P::flatness},
        {d.clearcoat, &P::clearcoat},   {d.clearcoat_gloss, &P::clearcoat_gloss}};
    for (const auto& [parameter, member] : scalars) {
      if (parameter.texture != kNoTexture) scalars_.push_back({texture_of(textures, parameter.texture), member});
    }
  }

  const Bsdf& add_to(BsdfSpace& space, const MaterialPoint& point) const override {
    PrincipledParameters p = constant_;
    p.base_color = colour_at(p.base_color, colour_, point.texture);
    for (const Scalar& scalar : scalars_) p.*scalar.member *= luminance(scalar.texture->value(point.texture));
    return space.make<PrincipledAtHit>(p, transmits_);
  }

 private:
  struct Scalar {
    const Texture* texture;
    float PrincipledParameters::*member;
  };

  PrincipledParameters constant_;
  bool transmits_;
  const Texture* colour_;
  std::vector<Scalar> scalars_;  // those with a texture
};

}  // namespace

std::unique_ptr<Bsdf> make_principled(const PrincipledDescription& d) {
  return std::make_unique<Principled>(constant_parameters(d));
}

std::unique_ptr<TexturedMaterial> make_textured_principled(const PrincipledDescription& d, const Textures& textures) {
  return std::make_unique<TexturedPrincipled>(d, textures);
}

}  // namespace fluxfarm
