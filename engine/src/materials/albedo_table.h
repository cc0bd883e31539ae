// Directional albedo of a rough BSDF by quadrature over its own sample(), kept as a table over the cosine.
//
// 32 cosines, 512 points each: within 0.02 of the exact value from 3 degrees above the horizon up. An anisotropic BSDF is averaged
// over the azimuth. Refracted light counts as flux: without the scaling of radiance.
#pragma once

#include <array>

#include "materials/bsdf.h"

namespace fluxfarm {

class AlbedoTable {
 public:
  enum class Side { kFront, kBack };

  // Calls bsdf.sample() only; everything that it needs must be constructed already.
  explicit AlbedoTable(const Bsdf& bsdf, Side side = Side::kFront);

  // cos_o in [0,1] on the side of the table.
  Rgb operator()(float cos_o) const {
    const float x = std::min(cos_o, 1.0f) * (kNodes - 1);
    const int i = std::min(static_cast<int>(x), kNodes - 2);
    const float t = x - static_cast<float>(i);
    return nodes_[static_cast<std::size_t>(i)] * (1 - t) + nodes_[static_cast<std::size_t>(i) + 1] * t;
  }

 private:
  static constexpr int kNodes = 32;
  std::array<Rgb, kNodes> nodes_;
};

}  // namespace fluxfarm
