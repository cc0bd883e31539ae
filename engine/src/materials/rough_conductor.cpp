// Rough metal: single scattering by microfacets that are mirrors with Fresnel's reflectance. One-sided: the back is black.
// Loses the light that the microfacets would scatter twice or more: a white one is not white at high roughness.
//
// [Walter07] B. Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007.
// [Heitz14]  E. Heitz and E. d'Eon, "Importance Sampling Microfacet-Based BSDFs using the Distribution of Visible Normals", EGSR
// 2014.
#include "materials/albedo_table.h"
#include "materials/beckmann.h"
#include "materials/bsdf_factories.h"
#include "materials/conductor_reflectance.h"
#include "materials/directions.h"
#include "materials/ggx.h"
#include "materials/textured_factories.h"

namespace fluxfarm {
namespace {

// All but the albedo.
template <class Distribution>
class RoughMirror : public Bsdf {
 public:
  explicit RoughMirror(const RoughConductorDescription& d)
      : distribution_(d.roughness.alpha_u, d.roughness.alpha_v), reflectance_(d.conductor) {}

  BsdfValue value(const Vec3f& wo, const Vec3f& wi) const override {
    if (wo.z <= 0 || wi.z <= 0) return {};
    const std::optional<Vec3f> m = half_vector(wo, wi, 1);
    if (!m) return {};
    const float d = distribution_.normal_density(*m);
    if (!(d > 0)) return {};
    // f = F D G1 G1 / (4 cos cos)  [Walter07]
    const float f = 0.25f * d * distribution_.masking_by_cosine(wo) * distribution_.masking_by_cosine(wi);
    return {reflectance_(dot(wo, *m)) * f, 0.25f * d * distribution_.visible_by_cosine(wo)};
  }

  std::optional<BsdfSample> sample(const Vec3f& wo, float, Vec2f u) const override {
    if (wo.z <= 0) return std::nullopt;
    const Vec3f m = distribution_.sample_normal(wo, u);
    const float cos_m = dot(wo, m);
    const Vec3f wi = reflect(wo, m, cos_m);
    if (cos_m <= 0 || wi.z <= 0) return std::nullopt;
    const float visible = distribution_.visible_by_cosine(wo);
    const float pdf = 0.25f * distribution_.normal_density(m) * visible;
    if (!(pdf > 0)) return std::nullopt;
    const float masking = distribution_.masking_by_cosine(wo) * distribution_.masking_by_cosine(wi) * wi.z / visible;
    return BsdfSample{.wi = wi, .weight = reflectance_(cos_m) * masking, .pdf = pdf};
  }

  bool has_continuous_lobe() const override { return true; }

 private:
  Distribution distribution_;
  ConductorReflectance reflectance_;
};

template <class Distribution>
class RoughConductor final : public RoughMirror<Distribution> {
 public:
  explicit RoughConductor(const RoughConductorDescription& d) : RoughMirror<Distribution>(d), albedo_(*this) {}

  Rgb albedo(const Vec3f& wo) const override { return wo.z > 0 ? albedo_(wo.z) : Rgb{}; }

 private:
  AlbedoTable albedo_;  // built by sampling the base class
};

// At a hit. The albedo is that of the mean roughness.
template <class Distribution>
class RoughConductorAtHit final : public RoughMirror<Distribution> {
 public:
  RoughConductorAtHit(const RoughConductorDescription& d, const Bsdf& white, Rgb colour)
      : RoughMirror<Distribution>(d), white_(white), colour_(colour) {}

  Rgb albedo(const Vec3f& wo) const override { return colour_ * white_.albedo(wo); }

 private:
  const Bsdf& white_;
  Rgb colour_;
};

template <class Distribution>
class TexturedRoughConductor final : public TexturedMaterial {
 public:
  TexturedRoughConductor(const RoughConductorDescription& d, const Textures& textures)
      : d_(d),
        colour_(texture_of(textures, d.conductor.specular_reflectance_texture)),
        alpha_(texture_of(textures, d.roughness.alpha_texture)),
        white_(at_alpha(luminance(alpha_->mean_value()), Rgb{1.0f})) {}

  const Bsdf& add_to(BsdfSpace& space, const MaterialPoint& point) const override {
    const Rgb colour = colour_at(d_.conductor.specular_reflectance, colour_, point.texture);
    return space.make<RoughConductorAtHit<Distribution>>(at_alpha(luminance(alpha_->value(point.texture)), colour), white_, colour);
  }

 private:
  RoughConductorDescription at_alpha(float factor, Rgb colour) const {
    RoughConductorDescription d = d_;
    d.roughness.alpha_u *= factor;
    d.roughness.alpha_v *= factor;
    d.conductor.specular_reflectance = colour;
    return d;
  }

  RoughConductorDescription d_;
  const Texture* colour_;
  const Texture* alpha_;
  RoughConductor<Distribution> white_;  // of the mean roughness
};

}  // namespace

std::unique_ptr<Bsdf> make_rough_conductor(const RoughConductorDescription& d) {
  if (d.roughness.distribution == MicrofacetDistribution::kGgx) return std::make_unique<RoughConductor<Ggx>>(d);
  return std::make_unique<RoughConductor<Beckmann>>(d);
}

std::unique_ptr<TexturedMaterial> make_textured_rough_conductor(const RoughConductorDescription& d, const Textures& textures) {
  if (d.roughness.distribution == MicrofacetDistribution::kGgx) {
    return std::make_unique<TexturedRoughConductor<Ggx>>(d, textures);
  }
  return std::make_unique<TexturedRoughConductor<Beckmann>>(d, textures);
}

}  // namespace fluxfarm
