// Diffuse base under a smooth dielectric coat: mirror reflection at the coat, and light that crosses it, is scattered by the base
// any number of times under the coat's internal reflection, and crosses back. One-sided.
//
// The base is that of Mitsuba's `plastic`: rho / (1 - rho R_i) with R_i the internal diffuse reflectance; without `nonlinear` the
// colour of the base does not deepen: rho / (1 - R_i).
#include "materials/bsdf_factories.h"
#include "materials/directions.h"
#include "materials/fresnel.h"
#include "materials/plastic_base.h"
#include "materials/textured_factories.h"
#include "sampling/warp.h"

namespace fluxfarm {
namespace {

class Plastic final : public Bsdf {
 public:
  explicit Plastic(const PlasticDescription& d)
      : eta_(d.eta),
        specular_(d.specular_reflectance),
        base_f_(plastic_base(d, fresnel_diffuse_reflectance(1 / d.eta))),
        lobes_(d),
        mean_transmittance_(1 - fresnel_diffuse_reflectance(d.eta)) {}

  BsdfValue value(const Vec3f& wo, const Vec3f& wi) const override {
    if (wo.z <= 0 || wi.z <= 0) return {};
    const float f_o = fresnel_dielectric(wo.z, eta_).reflectance;
    const float f_i = fresnel_dielectric(wi.z, eta_).reflectance;
    return {base_f_ * ((1 - f_o) * (1 - f_i)), (1 - lobes_.specular(f_o)) * (wi.z * kInvPi)};
  }

  std::optional<BsdfSample> sample(const Vec3f& wo, float u_lobe, Vec2f u) const override {
    if (wo.z <= 0) return std::nullopt;
    const float f_o = fresnel_dielectric(wo.z, eta_).reflectance;
    const float specular = lobes_.specular(f_o);
    if (u_lobe < specular) return BsdfSample{.wi = reflect(wo), .weight = specular_ * (f_o / specular), .delta = true};
    const Vec3f wi = square_to_cosine_hemisphere(u);
    const float pdf = (1 - specular) * (wi.z * kInvPi);
    if (!(pdf > 0)) return std::nullopt;
    const float f_i = fresnel_dielectric(wi.z, eta_).reflectance;
    return BsdfSample{.wi = wi, .weight = base_f_ * ((1 - f_o) * (1 - f_i) * kPi / (1 - specular)), .pdf = pdf};
  }

  // As exact as the fits of fresnel_diffuse_reflectance: 1 % for indices from 1.2 to 2.
  Rgb albedo(const Vec3f& wo) const override {
    if (wo.z <= 0) return {};
    const float f = fresnel_dielectric(wo.z, eta_).reflectance;
    return specular_ * f + base_f_ * (kPi * (1 - f) * mean_transmittance_);
  }
  bool has_continuous_lobe() const override { return true; }

 private:
  float eta_;
  Rgb specular_;
  Rgb base_f_;  // value of the base inside both crossings of the coat, sr^-1
  PlasticLobes lobes_;
  float mean_transmittance_;  // of the coat for diffuse light from outside
};

// Made anew at each hit: the coat has no tables, and the choice of the lobe follows the colours of the place.
class TexturedPlastic final : public TexturedMaterial {
 public:
  TexturedPlastic(const PlasticDescription& d, const Textures& textures)
      : d_(d),
        diffuse_(texture_of(textures, d.diffuse_reflectance_texture)),
        specular_(texture_of(textures, d.specular_reflectance_texture)) {}

  const Bsdf& add_to(BsdfSpace& space, const MaterialPoint& point) const override {
    PlasticDescription d = d_;
    d.diffuse_reflectance = colour_at(d.diffuse_reflectance, diffuse_, point.texture);
    d.specular_reflectance = colour_at(d.specular_reflectance, specular_, point.texture);
    return space.make<Plastic>(d);
  }

 private:
  PlasticDescription d_;
  const Texture* diffuse_;
  const Texture* specular_;
};

}  // namespace

std::unique_ptr<Bsdf> make_plastic(const PlasticDescription& d) { return std::make_unique<Plastic>(d); }

std::unique_ptr<TexturedMaterial> make_textured_plastic(const PlasticDescription& d, const Textures& textures) {
  return std::make_unique<TexturedPlastic>(d, textures);
}

}  // namespace fluxfarm
