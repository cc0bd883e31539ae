// Rough interface between two dielectrics (ground glass): single scattering by microfacets that reflect and refract as Fresnel and
// Snell say. Two-sided; interior is the side of -z. Refracted radiance scales by (eta_wo / eta_wi)^2.
// Loses the light that the microfacets would scatter twice or more. With equal indices the interface is invisible: smooth
// dielectric.
//
// [Walter07] B. Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007.
// [Heitz14]  E. Heitz and E. d'Eon, "Importance Sampling Microfacet-Based BSDFs using the Distribution of Visible Normals", EGSR
// 2014.
#include "materials/albedo_table.h"
#include "materials/beckmann.h"
#include "materials/bsdf_factories.h"
#include "materials/directions.h"
#include "materials/fresnel.h"
#include "materials/ggx.h"

namespace fluxfarm {
namespace {

template <class Distribution>
class RoughDielectric final : public Bsdf {
 public:
  explicit RoughDielectric(const RoughDielectricDescription& d)
      : distribution_(d.roughness.alpha_u, d.roughness.alpha_v),
        eta_(d.dielectric.eta),
        reflectance_(d.dielectric.specular_reflectance),
        transmittance_(d.dielectric.specular_transmittance),
        albedo_outside_(*this, AlbedoTable::Side::kFront),
        albedo_inside_(*this, AlbedoTable::Side::kBack) {}

  BsdfValue value(const Vec3f& wo, const Vec3f& wi) const override {
    if (wo.z == 0 || wi.z == 0) return {};
    const bool reflection = wo.z * wi.z > 0 || (wo.z > 0) == (wi.z > 0);
    const float eta = wo.z > 0 ? eta_ : 1 / eta_;
    const std::optional<Vec3f> m = half_vector(wo, wi, reflection ? 1 : eta);
    if (!m) return {};
    const float cos_o = dot(wo, *m), cos_i = dot(wi, *m);
    // Both directions must see the side of the microfacet that they see of the surface.
    if (cos_o * wo.z <= 0 || cos_i * wi.z <= 0) return {};
    const float d = distribution_.normal_density(*m);
    if (!(d > 0)) return {};
    const float fresnel = fresnel_dielectric(cos_o, eta_).reflectance;
    const float visible = distribution_.visible_by_cosine(wo);
    const float g = distribution_.masking_by_cosine(wo) * distribution_.masking_by_cosine(wi);
    if (reflection) return {reflectance_ * (0.25f * fresnel * d * g), 0.25f * fresnel * d * visible};
    return transmitted(fresnel, d, g, visible, cos_o, cos_i, eta);
  }

  std::optional<BsdfSample> sample(const Vec3f& wo, float u_lobe, Vec2f u) const override {
    if (wo.z == 0) return std::nullopt;
    const Vec3f m = distribution_.sample_normal(wo.z > 0 ? wo : -wo, u);
    const float cos_o = dot(wo, m);
    if (cos_o * wo.z <= 0) return std::nullopt;
    const float d = distribution_.normal_density(m);
    const float visible = distribution_.visible_by_cosine(wo);
    const DielectricFresnel fresnel = fresnel_dielectric(cos_o, eta_);

    if (u_lobe < fresnel.reflectance) {
      const Vec3f wi = reflect(wo, m, cos_o);
      const float pdf = 0.25f * fresnel.reflectance * d * visible;
      if (wi.z * wo.z <= 0 || !(pdf > 0)) return std::nullopt;
      return BsdfSample{.wi = wi, .weight = reflectance_ * masking_ratio(wo, wi, visible), .pdf = pdf};
    }
    const Vec3f wi = refract(wo, m, cos_o, fresnel.cos_t, fresnel.eta);
    const BsdfValue v = transmitted(fresnel.reflectance, d, 1, visible, cos_o, fresnel.cos_t, fresnel.eta);
    if (wi.z * wo.z >= 0 || !(v.pdf > 0)) return std::nullopt;
    return BsdfSample{
        .wi = wi, .weight = transmittance_ * (masking_ratio(wo, wi, visible) / sqr(fresnel.eta)), .pdf = v.pdf, .eta = fresnel.eta};
  }

  Rgb albedo(const Vec3f& wo) const override { return wo.z > 0 ? albedo_outside_(wo.z) : albedo_inside_(-wo.z); }
  bool has_continuous_lobe() const override { return true; }
  bool transmits() const override { return true; }

 private:
  // f = (1 - F) D G |cos_o cos_i| / (|wo.z wi.z| (cos_o + eta cos_i)^2) with the scaling of radiance; the pdf has the Jacobian of
  // the half vector, eta^2 |cos_i| / (cos_o + eta cos_i)^2.  [Walter07]
  BsdfValue transmitted(float fresnel, float d, float g, float visible, float cos_o, float cos_i, float eta) const {
    const float root = cos_o + eta * cos_i;
    const float jacobian = (1 - fresnel) * d * std::abs(cos_o * cos_i) / (root * root);
    if (!(jacobian <= 1e30f)) return {};
    return {transmittance_ * (jacobian * g), jacobian * visible * eta * eta};
  }

  float masking_ratio(const Vec3f& wo, const Vec3f& wi, float visible) const {
    return distribution_.masking_by_cosine(wo) * distribution_.masking_by_cosine(wi) * std::abs(wi.z) / visible;
  }

  Distribution distribution_;
  float eta_;
  Rgb reflectance_, transmittance_;
  AlbedoTable albedo_outside_, albedo_inside_;  // last: built by sampling the members above
};

}  // namespace

std::unique_ptr<Bsdf> make_rough_dielectric(const RoughDielectricDescription& d) {
  // Below this contrast the half vector of refraction loses its digits.
  if (std::abs(d.dielectric.eta - 1) < 1e-4f)
    return make_dielectric({1, d.dielectric.specular_reflectance, d.dielectric.specular_transmittance});
  if (d.roughness.distribution == MicrofacetDistribution::kGgx) return std::make_unique<RoughDielectric<Ggx>>(d);
  return std::make_unique<RoughDielectric<Beckmann>>(d);
}

}  // namespace fluxfarm
