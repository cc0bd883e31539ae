// Lambert's cosine law: the same radiance in all directions. One-sided: the back is black.
#include "materials/bsdf_factories.h"
#include "sampling/warp.h"

namespace fluxfarm {
namespace {

class Diffuse final : public Bsdf {
 public:
  explicit Diffuse(Rgb reflectance) : reflectance_(reflectance), f_(reflectance * kInvPi) {}

  BsdfValue value(const Vec3f& wo, const Vec3f& wi) const override {
    if (wo.z <= 0 || wi.z <= 0) return {};
    return {f_, wi.z * kInvPi};
  }

  std::optional<BsdfSample> sample(const Vec3f& wo, float, Vec2f u) const override {
    if (wo.z <= 0) return std::nullopt;
    const Vec3f wi = square_to_cosine_hemisphere(u);
    if (wi.z <= 0) return std::nullopt;
    return BsdfSample{.wi = wi, .weight = reflectance_, .pdf = wi.z * kInvPi};
  }

  Rgb albedo(const Vec3f& wo) const override { return wo.z > 0 ? reflectance_ : Rgb{}; }
  bool has_continuous_lobe() const override { return true; }
  bool chooses_lobe() const override { return false; }

 private:
  Rgb reflectance_, f_;
};

}  // namespace

std::unique_ptr<Bsdf> make_diffuse(const DiffuseDescription& d) { return std::make_unique<Diffuse>(d.reflectance); }

}  // namespace fluxfarm
