// [Roberts18] M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018: the additive recurrence R_d.
#include "materials/albedo_table.h"

namespace fluxfarm {
namespace {

constexpr int kPoints = 512;

float fraction(double x) { return static_cast<float>(x - static_cast<double>(static_cast<long>(x))) * 0.9999999f; }

}  // namespace

AlbedoTable::AlbedoTable(const Bsdf& bsdf, Side side) {
  for (int i = 0; i < kNodes; ++i) {
    const float z = std::max(static_cast<float>(i) / (kNodes - 1), 1e-4f);
    const float r = safe_sqrt(1 - z * z);
    Rgb sum;
    for (int j = 0; j < kPoints; ++j) {
      // R_4: lobe, direction and azimuth of wo. The azimuth of an isotropic BSDF does no harm.
      const double k = j + 0.5;
      const float angle = fraction(k * 0.8566748838545029) * kTwoPi;
      const Vec3f wo{r * std::cos(angle), r * std::sin(angle), side == Side::kFront ? z : -z};
      const auto s =
          bsdf.sample(wo, fraction(k * 0.7338918566271260), {fraction(k * 0.6287067210378087), fraction(k * 0.5385972572236101)});
      if (s) sum += s->weight * sqr(s->eta);
    }
    nodes_[static_cast<std::size_t>(i)] = sum / static_cast<float>(kPoints);
  }
}

}  // namespace fluxfarm
