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

namespace fluxfarm {
namespace {

template <class Distribution>
class RoughPlastic final : public Bsdf {
 public:
  explicit RoughPlastic(const RoughPlasticDescription& d)
      : distribution_(d.roughness.alpha_u, d.roughness.alpha_u),
        coat_(distribution_, d.plastic.eta),
        eta_(d.plastic.eta),
        specular_(d.plastic.specular_reflectance),
        base_f_(plastic_base(d.plastic, coat_.internal_reflectance())),
        lobes_(d.plastic),
        albedo_(*this) {}

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

  Rgb albedo(const Vec3f& wo) const override { return wo.z > 0 ? albedo_(wo.z) : Rgb{}; }
  bool has_continuous_lobe() const override { return true; }

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
  CoatTable coat_;
  float eta_;
  Rgb specular_;
  Rgb base_f_;  // value of the base inside both crossings of the coat, sr^-1
  PlasticLobes lobes_;
  AlbedoTable albedo_;  // last: built by sampling the members above
};

}  // namespace

std::unique_ptr<Bsdf> make_rough_plastic(const RoughPlasticDescription& d) {
  if (d.roughness.distribution == MicrofacetDistribution::kGgx) return std::make_unique<RoughPlastic<Ggx>>(d);
  return std::make_unique<RoughPlastic<Beckmann>>(d);
}

}  // namespace fluxfarm
