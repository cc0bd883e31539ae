// The BSDFs and directions that the tests of this folder go through.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "materials/make_bsdf.h"

namespace fluxfarm::testing {

struct MaterialCase {
  std::string name;
  MaterialDescription description;
  float alpha = 1;  // the smaller roughness; 1 for a wide lobe
};

inline Roughness beckmann(float alpha) { return {MicrofacetDistribution::kBeckmann, alpha, alpha}; }
inline Roughness ggx(float alpha) { return {MicrofacetDistribution::kGgx, alpha, alpha}; }

// Gold-like, as used in the table of Mitsuba's values.
inline ConductorDescription gold() {
  ConductorDescription d;
  d.eta = {0.14f, 0.37f, 1.44f};
  d.k = {3.98f, 2.38f, 1.6f};
  return d;
}
inline ConductorDescription perfect_mirror() {
  ConductorDescription d;
  d.perfect = true;
  return d;
}
inline PlasticDescription painted_plastic(bool nonlinear = false) {
  PlasticDescription d;
  d.diffuse_reflectance = {0.8f, 0.4f, 0.1f};
  d.nonlinear = nonlinear;
  return d;
}

inline std::vector<MaterialCase> continuous_cases() {
  std::vector<MaterialCase> cases{{"diffuse", DiffuseDescription{{0.7f, 0.5f, 0.2f}}},
                                  {"plastic", painted_plastic()},
                                  {"plastic_nonlinear", painted_plastic(true)}};
  for (const float alpha : {0.001f, 0.05f, 0.3f, 0.9f}) {
    for (const bool is_ggx : {false, true}) {
      const Roughness r = is_ggx ? ggx(alpha) : beckmann(alpha);
      const std::string suffix = (is_ggx ? "_ggx_" : "_beckmann_") + std::to_string(alpha);
      cases.push_back({"roughconductor" + suffix, RoughConductorDescription{gold(), r}, alpha});
      cases.push_back({"roughdielectric" + suffix, RoughDielectricDescription{{}, r}, alpha});
      cases.push_back({"roughplastic" + suffix, RoughPlasticDescription{painted_plastic(), r}, alpha});
    }
  }
  cases.push_back({"roughconductor_anisotropic_beckmann",
                   RoughConductorDescription{gold(), {MicrofacetDistribution::kBeckmann, 0.2f, 0.6f}}, 0.2f});
  cases.push_back(
      {"roughdielectric_anisotropic_ggx", RoughDielectricDescription{{}, {MicrofacetDistribution::kGgx, 0.5f, 0.2f}}, 0.2f});
  DielectricDescription diamond;
  diamond.eta = 2.4f;
  cases.push_back({"roughdielectric_diamond", RoughDielectricDescription{diamond, ggx(0.3f)}, 0.3f});
  return cases;
}

inline std::unique_ptr<Bsdf> make(const MaterialDescription& description) { return std::move(make_bsdfs({description})[0]); }

// Unit direction at cosine z, azimuth phi in radians.
inline Vec3f direction(float z, float phi) {
  const float r = safe_sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

}  // namespace fluxfarm::testing
