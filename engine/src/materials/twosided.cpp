// Gives a one-sided surface a back: the side of wo decides which of two BSDFs is asked, in a frame whose z is on that side.
#include "materials/bsdf_factories.h"

namespace fluxfarm {
namespace {

Vec3f flipped(Vec3f w) { return {w.x, w.y, -w.z}; }

class Twosided final : public Bsdf {
 public:
  Twosided(const Bsdf& front, const Bsdf& back) : front_(front), back_(back) {}

  BsdfValue value(Vec3f wo, Vec3f wi) const override {
    return wo.z > 0 ? front_.value(wo, wi) : back_.value(flipped(wo), flipped(wi));
  }

  std::optional<BsdfSample> sample(Vec3f wo, float u_lobe, Vec2f u) const override {
    if (wo.z > 0) return front_.sample(wo, u_lobe, u);
    std::optional<BsdfSample> s = back_.sample(flipped(wo), u_lobe, u);
    if (s) s->wi.z = -s->wi.z;
    return s;
  }

  Rgb albedo(Vec3f wo) const override { return wo.z > 0 ? front_.albedo(wo) : back_.albedo(flipped(wo)); }
  bool has_continuous_lobe() const override { return front_.has_continuous_lobe() || back_.has_continuous_lobe(); }

 private:
  const Bsdf& front_;
  const Bsdf& back_;
};

}  // namespace

std::unique_ptr<Bsdf> make_twosided(const Bsdf& front, const Bsdf& back) { return std::make_unique<Twosided>(front, back); }

}  // namespace fluxfarm
