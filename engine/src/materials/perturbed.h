// A BSDF asked in another frame than that of the surface: what normal maps and bump maps come to.
//
// As Mitsuba 3.6 does it: a direction that lies above the surface but below the tilted one, or the other way round, carries no
// light. So a tilted normal darkens, and one that points below the surface leaves next to nothing; nothing is turned back or
// shadowed. Not reciprocal: the cosine at the light is that of the tilted normal.
#pragma once

#include <cmath>

#include "materials/bsdf.h"
#include "math/frame.h"

namespace fluxfarm {

// Frame around the unit normal n, both in the frame of the surface: its s is the surface's own, as far as n allows.
inline Frame tilted_frame(Vec3f n) {
  Frame frame(n);
  const Vec3f s = Vec3f{1, 0, 0} - n * n.x;
  const float squared = length_squared(s);
  if (!(squared > 1e-12f)) return frame;
  frame.s = s / std::sqrt(squared);
  frame.t = cross(n, frame.s);
  return frame;
}

class PerturbedBsdf final : public Bsdf {
 public:
  PerturbedBsdf(const Bsdf& nested, const Frame& frame) : nested_(nested), frame_(frame) {}

  BsdfValue value(const Vec3f& wo, const Vec3f& wi) const override {
    const Vec3f tilted = frame_.to_local(wi);
    if (!(wi.z * tilted.z > 0)) return {};
    const BsdfValue v = nested_.value(frame_.to_local(wo), tilted);
    return {v.f * (tilted.z / wi.z), v.pdf};
  }

  std::optional<BsdfSample> sample(const Vec3f& wo, float u_lobe, Vec2f u) const override {
    std::optional<BsdfSample> s = nested_.sample(frame_.to_local(wo), u_lobe, u);
    if (!s) return s;
    const Vec3f wi = frame_.to_world(s->wi);
    if (!(wi.z * s->wi.z > 0)) return std::nullopt;
    s->wi = wi;
    return s;
  }

  Rgb albedo(const Vec3f& wo) const override { return nested_.albedo(frame_.to_local(wo)); }
  bool has_continuous_lobe() const override { return nested_.has_continuous_lobe(); }
  bool chooses_lobe() const override { return nested_.chooses_lobe(); }
  bool transmits() const override { return nested_.transmits(); }

 private:
  const Bsdf& nested_;
  Frame frame_;
};

}  // namespace fluxfarm
