// Diffuse base under a rough dielectric coat: microfacet reflection at the coat, and a base that sees tabulated transmittances.
// One-sided. As in Mitsuba's `roughplastic`; see plastic.cpp for the base and coat_table.h for the tables.
//
// [Walter07] B. Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007.
#include "materials/albedo_table.h"
#include "materials/beckmann.h"
#include "materials/bsdf_factories.h"
#include "materials/coat_table.h"
#include "materials/directions.h"
#include "materials/fresnel.h"
#include "materials/ggx.h"
#include "materials/plastic_base.h"
#include "materials/textured_factories.h"

namespace fluxfarm {
namespace {

// All but the albedo. `Coat` is CoatTable, or a reference to one that is shared.
template <class Distribution, class Coat>
class CoatedBase : public Bsdf {
 public:
  CoatedBase(const RoughPlasticDescription& d, const Distribution& distribution, const CoatTable& coat)
      : distribution_(distribution),
        coat_(coat),
        eta_(d.plastic.eta),
        specular_(d.plastic.specular_reflectance),
        base_f_(plastic_base(d.plastic, coat_.internal_reflectance())),
        lobes_(d.plastic) {}

  BsdfValue value(const Vec3f& wo, const Vec3f& wi) const override {
    if (wo.z <= 0 || wi.z <= 0) return {};
    const float t_o = coat_.transmittance(wo.z);
    return value(wo, wi, t_o, lobes_.specular(1 - t_o));
  }

  std::optional<BsdfSample> sample(const Vec3f& wo, float u_lobe, Vec2f u) const override {
    if (wo.z <= 0) return std::nullopt;
    const float t_o = coat_.transmittance(wo.z);
    const float specular = lobes_.specular(1 - t_o);
    Vec3f wi;
    if (u_lobe < specular) {
      const Vec3f m = distribution_.sample_normal(wo, u);
      wi = reflect(wo, m, dot(wo, m));
    } else {
      wi = square_to_cosine_hemisphere(u);
    }
    if (wi.z <= 0) return std::nullopt;
    const BsdfValue v = value(wo, wi, t_o, specular);
    if (!(v.pdf > 0)) return std::nullopt;
    return BsdfSample{.wi = wi, .weight = v.f * (wi.z / v.pdf), .pdf = v.pdf};
  }

  bool has_continuous_lobe() const override { return true; }

 protected:
  const CoatTable& coat() const { return coat_; }
  Rgb specular() const { return specular_; }
  // Albedo of the base through the coat, for wo.z > 0.
  Rgb base_albedo(const Vec3f& wo) const { return base_f_ * (kPi * coat_.transmittance(wo.z) * coat_.mean_transmittance()); }

 private:
  BsdfValue value(const Vec3f& wo, const Vec3f& wi, float t_o, float specular) const {
    BsdfValue v{base_f_ * (t_o * coat_.transmittance(wi.z)), (1 - specular) * (wi.z * kInvPi)};
    const std::optional<Vec3f> m = half_vector(wo, wi, 1);
    if (!m) return v;
    const float d = distribution_.normal_density(*m);
    if (!(d > 0)) return v;
    const float fresnel = fresnel_dielectric(dot(wo, *m), eta_).reflectance;
    const float g = distribution_.masking_by_cosine(wo) * distribution_.masking_by_cosine(wi);
    v.f += specular_ * (0.25f * fresnel * d * g);
    v.pdf += specular * 0.25f * d * distribution_.visible_by_cosine(wo);
    return v;
  }

  Distribution distribution_;
  Coat coat_;
  float eta_;
  Rgb specular_;
  Rgb base_f_;  // value of the base inside both crossings of the coat, sr^-1
  PlasticLobes lobes_;
};

template <class Distribution>
Distribution isotropic(const RoughPlasticDescription& d) {
  return {d.roughness.alpha_u, d.roughness.alpha_u};
}

template <class Distribution>
class RoughPlastic final : public CoatedBase<Distribution, CoatTable> {
 public:
  explicit RoughPlastic(const RoughPlasticDescription& d)
      : CoatedBase<Distribution, CoatTable>(d, isotropic<Distribution>(d), CoatTable(isotropic<Distribution>(d), d.plastic.eta)),
        albedo_(*this) {}

  Rgb albedo(const Vec3f& wo) const override { return wo.z > 0 ? albedo_(wo.z) : Rgb{}; }
  using CoatedBase<Distribution, CoatTable>::coat;

 private:
  AlbedoTable albedo_;  // built by sampling the base class
};

// At a hit, with the tables of a coat over black.
template <class Distribution>
class RoughPlasticAtHit final : public CoatedBase<Distribution, const CoatTable&> {
 public:
  RoughPlasticAtHit(const RoughPlasticDescription& d, const RoughPlastic<Distribution>& coat)
      : CoatedBase<Distribution, const CoatTable&>(d, isotropic<Distribution>(d), coat.coat()), over_black_(coat) {}

  Rgb albedo(const Vec3f& wo) const override {
    if (wo.z <= 0) return {};
    return this->specular() * over_black_.albedo(wo) + this->base_albedo(wo);
  }

 private:
  const Bsdf& over_black_;
};

template <class Distribution>
class TexturedRoughPlastic final : public TexturedMaterial {
 public:
  TexturedRoughPlastic(const RoughPlasticDescription& d, const Textures& textures)
      : d_(d),
        diffuse_(texture_of(textures, d.plastic.diffuse_reflectance_texture)),
        specular_(texture_of(textures, d.plastic.specular_reflectance_texture)),
        coat_(coloured(Rgb{0.0f}, Rgb{1.0f})) {}

  const Bsdf& add_to(BsdfSpace& space, const MaterialPoint& point) const override {
    const Rgb diffuse = colour_at(d_.plastic.diffuse_reflectance, diffuse_, point.texture);
    const Rgb specular = colour_at(d_.plastic.specular_reflectance, specular_, point.texture);
    return space.make<RoughPlasticAtHit<Distribution>>(coloured(diffuse, specular), coat_);
  }

 private:
  RoughPlasticDescription coloured(Rgb diffuse, Rgb specular) const {
    RoughPlasticDescription d = d_;
    d.plastic.diffuse_reflectance = diffuse;
    d.plastic.specular_reflectance = specular;
    return d;
  }

  RoughPlasticDescription d_;
  const Texture* diffuse_;
  const Texture* specular_;
  RoughPlastic<Distribution> coat_;
};

}  // namespace

std::unique_ptr<Bsdf> make_rough_plastic(const RoughPlasticDescription& d) {
  if (d.roughness.distribution == MicrofacetDistribution::kGgx) return std::make_unique<RoughPlastic<Ggx>>(d);
  return std::make_unique<RoughPlastic<Beckmann>>(d);
}

std::unique_ptr<TexturedMaterial> make_textured_rough_plastic(const RoughPlasticDescription& d, const Textures& textures) {
  if (d.roughness.distribution == MicrofacetDistribution::kGgx) {
    return std::make_unique<TexturedRoughPlastic<Ggx>>(d, textures);
  }
  return std::make_unique<TexturedRoughPlastic<Beckmann>>(d, textures);
}

}  // namespace fluxfarm
