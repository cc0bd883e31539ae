// Smooth metal: a mirror with Fresnel's reflectance for a complex index. One-sided: the back is black.
#include "materials/bsdf_factories.h"
#include "materials/conductor_reflectance.h"
#include "materials/directions.h"

namespace fluxfarm {
namespace {

class Conductor final : public Bsdf {
 public:
  explicit Conductor(const ConductorDescription& d) : reflectance_(d) {}

  BsdfValue value(const Vec3f&, const Vec3f&) const override { return {}; }

  std::optional<BsdfSample> sample(const Vec3f& wo, float, Vec2f) const override {
    if (wo.z <= 0) return std::nullopt;
    return BsdfSample{.wi = reflect(wo), .weight = reflectance_(wo.z), .delta = true};
  }

  Rgb albedo(const Vec3f& wo) const override { return wo.z > 0 ? reflectance_(wo.z) : Rgb{}; }
  bool has_continuous_lobe() const override { return false; }

 private:
  ConductorReflectance reflectance_;
};

}  // namespace

std::unique_ptr<Bsdf> make_conductor(const ConductorDescription& d) { return std::make_unique<Conductor>(d); }

}  // namespace fluxfarm
