#include "materials/charlie_sheen.h"

namespace fluxfarm {

const CharlieAlbedo& CharlieAlbedo::table() {
  static const CharlieAlbedo table;
  return table;
}

CharlieAlbedo::CharlieAlbedo() {
  // Midpoints over wi uniform on the hemisphere: the integrand has no narrow peak but at grazing angles.
  constexpr int kCosines = 64, kAngles = 64;
  for (std::size_t r = 0; r < kNodes; ++r) {
    const float alpha = charlie_alpha(static_cast<float>(r) / (kNodes - 1));
    for (std::size_t c = 0; c < kNodes; ++c) {
      const float cos_o = std::max(static_cast<float>(c) / (kNodes - 1), 1e-3f);
      const Vec3f wo{safe_sqrt(1 - cos_o * cos_o), 0, cos_o};
      double sum = 0;
      for (int i = 0; i < kCosines; ++i) {
        const float cos_i = (static_cast<float>(i) + 0.5f) / kCosines, sin_i = safe_sqrt(1 - cos_i * cos_i);
        for (int j = 0; j < kAngles; ++j) {
          const float phi = (static_cast<float>(j) + 0.5f) / kAngles * kPi;
          const Vec3f h = normalize(wo + Vec3f{sin_i * std::cos(phi), sin_i * std::sin(phi), cos_i});
          sum += static_cast<double>(charlie_sheen(alpha, cos_o, cos_i, h.z) * cos_i);
        }
      }
      nodes_[r][c] = static_cast<float>(sum * 2 * static_cast<double>(kPi) / (kCosines * kAngles));
    }
  }
}

float CharlieAlbedo::operator()(float cos, float roughness) const {
  const auto split = [](float x) {
    const float scaled = std::min(std::max(x, 0.0f), 1.0f) * (kNodes - 1);
    const std::size_t i = std::min(static_cast<std::size_t>(scaled), kNodes - 2);
    return std::pair{i, scaled - static_cast<float>(i)};
  };
  const auto [r, s] = split(roughness);
  const auto [c, t] = split(cos);
  const auto row = [this, c = c, t = t](std::size_t i) { return nodes_[i][c] * (1 - t) + nodes_[i][c + 1] * t; };
  return row(r) * (1 - s) + row(r + 1) * s;
}

}  // namespace fluxfarm
