// Smooth interface between two dielectrics (glass): mirror reflection and Snell's refraction, chosen by Fresnel's reflectance.
// Two-sided; interior is the side of -z. Refracted radiance scales by (eta_wo / eta_wi)^2.
#include "materials/bsdf_factories.h"
#include "materials/directions.h"
#include "materials/fresnel.h"

namespace fluxfarm {
namespace {

class Dielectric final : public Bsdf {
 public:
  explicit Dielectric(const DielectricDescription& d)
      : eta_(d.eta), reflectance_(d.specular_reflectance), transmittance_(d.specular_transmittance) {}

  BsdfValue value(const Vec3f&, const Vec3f&) const override { return {}; }

  std::optional<BsdfSample> sample(const Vec3f& wo, float u_lobe, Vec2f) const override {
    if (wo.z == 0) return std::nullopt;
    const DielectricFresnel fresnel = fresnel_dielectric(wo.z, eta_);
    if (u_lobe < fresnel.reflectance) return BsdfSample{.wi = reflect(wo), .weight = reflectance_, .delta = true};
    const float inverse = 1 / fresnel.eta;
    return BsdfSample{.wi = {-wo.x * inverse, -wo.y * inverse, fresnel.cos_t},
                      .weight = transmittance_ * (inverse * inverse),
                      .delta = true,
                      .eta = fresnel.eta};
  }

  // Of flux: without the scaling of radiance.
  Rgb albedo(const Vec3f& wo) const override {
    const float f = fresnel_dielectric(wo.z, eta_).reflectance;
    return reflectance_ * f + transmittance_ * (1 - f);
  }
  bool has_continuous_lobe() const override { return false; }
  bool transmits() const override { return true; }

 private:
  float eta_;
  Rgb reflectance_, transmittance_;
};

}  // namespace

std::unique_ptr<Bsdf> make_dielectric(const DielectricDescription& d) { return std::make_unique<Dielectric>(d); }

}  // namespace fluxfarm
