// Sheen of cloth: a microfacet layer whose normals lie flat, with the "Charlie" distribution and a smooth shadowing.
//
// [Estevez17]  A. Conty Estevez and C. Kulla, "Production Friendly Microfacet Sheen BRDF", SIGGRAPH 2017 course notes.
// [Neubelt13]  D. Neubelt and M. Pettineo, "Crafting a Next-Gen Material Pipeline for The Order: 1886", SIGGRAPH 2013 course notes.
#pragma once

#include <array>
#include <cmath>
#include <utility>

#include "math/vec.h"

namespace fluxfarm {

// Value for white sheen, without cosine, sr^-1, of directions above the surface with half vector cosine `h_z`. D of [Estevez17]
// with the visibility of [Neubelt13], as KHR_materials_sheen allows. alpha > 0.
inline float charlie_sheen(float alpha, float cos_o, float cos_i, float h_z) {
  const float inverse = 1 / alpha, sine = safe_sqrt(1 - h_z * h_z);
  const float density = (2 + inverse) * std::pow(sine, inverse) * (0.5f * kInvPi);
  return density / (4 * (cos_o + cos_i - cos_o * cos_i));
}

// Directional albedo of white sheen over cosine and perceptual roughness, by quadrature when first asked for.
class CharlieAlbedo {
 public:
  static const CharlieAlbedo& table();
  // cos in [0,1], roughness in [0,1].
  float operator()(float cos, float roughness) const;

 private:
  CharlieAlbedo();
  static constexpr std::size_t kNodes = 16;
  std::array<std::array<float, kNodes>, kNodes> nodes_{};  // [roughness][cosine]
};

// alpha of a perceptual roughness; the smallest keeps the distribution finite.
inline float charlie_alpha(float roughness) { return sqr(std::max(roughness, 0.07f)); }

}  // namespace fluxfarm
