// GGX (Trowbridge-Reitz) distribution of microfacet normals with Smith masking, possibly anisotropic.
//
// [Walter07] B. Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007.
// [Heitz14]  E. Heitz, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 3(2), 2014.
// [Dupuy23]  J. Dupuy and A. Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023.
//
// Every distribution of this folder has the four members below; BSDFs take it as a template parameter. Masking is divided by the
// cosine, which keeps it finite at grazing angles; shadowing and masking are separable: G = G1(wo) G1(wi).
#pragma once

#include "materials/material_description.h"
#include "math/vec.h"
#include "sampling/warp.h"

namespace fluxfarm {

// Smaller roughness is taken as this one: single precision resolves no narrower lobe.
inline constexpr float kMinAlpha = 1e-4f;

class Ggx {
 public:
  Ggx(float alpha_u, float alpha_v)
      : alpha_u_(std::max(alpha_u, kMinAlpha)),
        alpha_v_(std::max(alpha_v, kMinAlpha)),
        inv_alpha_u_(1 / alpha_u_),
        inv_alpha_v_(1 / alpha_v_),
        scale_(kInvPi * inv_alpha_u_ * inv_alpha_v_) {}

  // D(m), per steradian and unit of macroscopic area; m.z >= 0.
  float normal_density(Vec3f m) const {
    const float q = sqr(m.x * inv_alpha_u_) + sqr(m.y * inv_alpha_v_) + m.z * m.z;
    return scale_ / (q * q);
  }

  // G1(v) / |cos v|, on the side where v sees the front of the microfacets.
  float masking_by_cosine(Vec3f v) const {
    return 2 / (std::abs(v.z) + std::sqrt(v.z * v.z + sqr(alpha_u_ * v.x) + sqr(alpha_v_ * v.y)));
  }
  // The same, as it normalises the density of visible normals: D_v(m) = D(m) |wo.m| visible_by_cosine(wo).
  float visible_by_cosine(Vec3f v) const { return masking_by_cosine(v); }

  // A normal in proportion to D_v(m), for wo.z > 0: the half vector of the stretched wo and a point of the spherical cap that it
  // sees [Dupuy23]. The cap is mapped from a disk, so no trigonometry is needed. Its z is 0 only on the rim of the disk.
  Vec3f sample_normal(Vec3f wo, Vec2f u) const {
    const Vec3f w = normalize({alpha_u_ * wo.x, alpha_v_ * wo.y, wo.z});
    const Vec2f p = square_to_uniform_disk(u);
    const float r2 = std::min(p.x * p.x + p.y * p.y, 1.0f);
    const float height = 1 + w.z;
    const float scale = safe_sqrt(height * (2 - r2 * height));
    const Vec3f h{alpha_u_ * (p.x * scale + w.x), alpha_v_ * (p.y * scale + w.y), height * (1 - r2)};
    const float length2 = length_squared(h);
    return length2 > 0 ? h * (1 / std::sqrt(length2)) : Vec3f{0, 0, 1};
  }

 private:
  float alpha_u_, alpha_v_, inv_alpha_u_, inv_alpha_v_, scale_;
};

}  // namespace fluxfarm
