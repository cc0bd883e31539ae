// No surface: all light passes straight through, unchanged. Bounds a medium whose index of refraction is that around it.
#include "materials/bsdf_factories.h"
#include "materials/directions.h"

namespace fluxfarm {
namespace {

class Null final : public Bsdf {
 public:
  BsdfValue value(const Vec3f&, const Vec3f&) const override { return {}; }
  std::optional<BsdfSample> sample(const Vec3f& wo, float, Vec2f) const override { return pass(wo); }
  Rgb albedo(const Vec3f&) const override { return Rgb{1.0f}; }
  bool has_continuous_lobe() const override { return false; }
  bool chooses_lobe() const override { return false; }
  bool transmits() const override { return true; }
};

}  // namespace

std::unique_ptr<Bsdf> make_null() { return std::make_unique<Null>(); }

}  // namespace fluxfarm
