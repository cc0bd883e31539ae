// A pane of glass, thinner than anything that could be seen of its inside: mirror reflection, and transmission straight on.
// Both count all the reflections between its two faces.
//
// With R the reflectance of one face: R + R (1 - R)^2 / (1 - R^2) = 2 R / (1 + R) is reflected, the rest transmitted.
#include "materials/bsdf_factories.h"
#include "materials/directions.h"
#include "materials/fresnel.h"

namespace fluxfarm {
namespace {

class ThinDielectric final : public Bsdf {
 public:
  explicit ThinDielectric(const DielectricDescription& d)
      : eta_(d.eta), reflectance_(d.specular_reflectance), transmittance_(d.specular_transmittance) {}

  BsdfValue value(const Vec3f&, const Vec3f&) const override { return {}; }

  std::optional<BsdfSample> sample(const Vec3f& wo, float u_lobe, Vec2f) const override {
    if (wo.z == 0) return std::nullopt;
    if (u_lobe < reflected(wo)) return BsdfSample{.wi = reflect(wo), .weight = reflectance_, .delta = true};
    return straight_on(wo, transmittance_);
  }

  Rgb albedo(const Vec3f& wo) const override {
    const float r = reflected(wo);
    return reflectance_ * r + transmittance_ * (1 - r);
  }
  bool has_continuous_lobe() const override { return false; }
  bool transmits() const override { return true; }

 private:
  float reflected(const Vec3f& wo) const {
    const float r = fresnel_dielectric(std::abs(wo.z), eta_).reflectance;
    return 2 * r / (1 + r);
  }

  float eta_;
  Rgb reflectance_, transmittance_;
};

}  // namespace

std::unique_ptr<Bsdf> make_thin_dielectric(const ThinDielectricDescription& d) {
  return std::make_unique<ThinDielectric>(d.dielectric);
}

}  // namespace fluxfarm
