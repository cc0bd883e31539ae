#include "materials/coat_table.h"

#include "materials/beckmann.h"
#include "materials/directions.h"
#include "materials/fresnel.h"
#include "materials/ggx.h"

namespace fluxfarm {
namespace {

struct CoatResponse {
  float reflectance = 0, transmittance = 0;
};

// One of `points` abscissae in (0,1) with its weight: the midpoint rule after t^3 (10 - 15 t + 6 t^2), which gathers points at the
// ends, where the tails of the distributions are.
struct Abscissa {
  Abscissa(int i, int points) {
    const float step = 1 / static_cast<float>(points), t = (static_cast<float>(i) + 0.5f) * step;
    position = t * t * t * (10 - 15 * t + 6 * t * t);
    weight = 30 * sqr(t * (1 - t)) * step;
  }
  float position, weight;
};

// Product rule over the square of sample_normal, which takes up D_v. wo.y = 0: both halves in u.y are the same, one is enough.
template <class Distribution>
CoatResponse integrate(const Distribution& distribution, Vec3f wo, float eta, int points) {
  CoatResponse sum;
  for (int i = 0; i < points; ++i) {
    for (int j = 0; j < points / 2; ++j) {
      const Abscissa x(i, points), y(j, points);
      const Vec3f m = distribution.sample_normal(wo, {x.position, y.position});
      const float cos_m = dot(wo, m), weight = 2 * x.weight * y.weight;
      if (cos_m <= 0) continue;
      const DielectricFresnel fresnel = fresnel_dielectric(cos_m, eta);
      const Vec3f up = reflect(wo, m, cos_m);
      if (up.z > 0) sum.reflectance += weight * fresnel.reflectance * distribution.masking_by_cosine(up) * up.z;
      const Vec3f down = refract(wo, m, cos_m, fresnel.cos_t, fresnel.eta);
      if (down.z < 0) sum.transmittance -= weight * (1 - fresnel.reflectance) * distribution.masking_by_cosine(down) * down.z;
    }
  }
  return sum;
}

}  // namespace

template <class Distribution>
CoatTable::CoatTable(const Distribution& distribution, float eta) {
  constexpr int kExternalPoints = 16, kInternalPoints = 24;
  float internal = 0;
  for (std::size_t i = 0; i < transmittance_.size(); ++i) {
    const float cos = std::max(static_cast<float>(i) / (kNodes - 1), 1e-6f);
    const Vec3f wo{safe_sqrt(1 - cos * cos), 0, cos};
    transmittance_[i] = std::min(integrate(distribution, wo, eta, kExternalPoints).transmittance, 1.0f);
    internal += integrate(distribution, wo, 1 / eta, kInternalPoints).reflectance * cos;
  }
  internal_reflectance_ = 2 * internal / kNodes;
  // 2 times the integral of transmittance(cos) cos over [0,1], exactly for the linear interpolant.
  for (std::size_t i = 0; i + 1 < transmittance_.size(); ++i) {
    const float a = static_cast<float>(i) / (kNodes - 1), b = static_cast<float>(i + 1) / (kNodes - 1);
    const float t_a = transmittance_[i], t_b = transmittance_[i + 1];
    mean_transmittance_ += (b - a) / 3 * (t_a * (2 * a + b) + t_b * (a + 2 * b));
  }
}

template CoatTable::CoatTable(const Ggx&, float);
template CoatTable::CoatTable(const Beckmann&, float);

}  // namespace fluxfarm
