// Principled materials that the tests of this folder go through, by the names of mitsuba_principled.inc.
#pragma once

#include <cmath>

#include "cases.h"

namespace fluxfarm::testing {

// The index of refraction that Mitsuba's `specular` means.
inline float eta_of_specular(float specular) { return 2 / (1 - std::sqrt(0.08f * specular)) - 1; }

inline std::vector<MaterialCase> principled_cases() {
  std::vector<MaterialCase> cases;
  const auto add = [&](const std::string& name, float alpha, auto&& change) {
    PrincipledDescription d;
    d.base_color = {0.8f, 0.4f, 0.1f};
    d.eta = eta_of_specular(0.5f);
    change(d);
    cases.push_back({name, d, alpha});
  };
  using D = PrincipledDescription;
  add("plain", 0.25f, [](D&) {});
  add("metal", 0.09f, [](D& d) { d.metallic = {1}, d.roughness = {0.3f}; });
  add("metal_aniso", 0.19f, [](D& d) { d.metallic = {0.7f}, d.roughness = {0.6f}, d.anisotropic = {0.8f}; });
  add("tinted", 0.16f, [](D& d) { d.eta = eta_of_specular(0.8f), d.spec_tint = {0.6f}, d.roughness = {0.4f}; });
  add("cloth", 0.81f, [](D& d) { d.sheen = {0.9f}, d.sheen_tint = {0.4f}, d.roughness = {0.9f}; });
  add("flat", 0.64f, [](D& d) { d.flatness = {0.7f}, d.roughness = {0.8f}; });
  add("coat", 0.07f, [](D& d) { d.clearcoat = {0.8f}, d.clearcoat_gloss = {0.3f}, d.roughness = {0.6f}; });
  add("coat_matt", 0.1f, [](D& d) { d.clearcoat = {1}, d.metallic = {0.5f}, d.roughness = {0.5f}; });
  add("glass", 0.16f, [](D& d) { d.spec_trans = {1}, d.eta = 1.5f, d.roughness = {0.4f}; });
  add("half_glass", 0.18f,
      [](D& d) { d.spec_trans = {0.5f}, d.eta = 1.33f, d.roughness = {0.5f}, d.metallic = {0.2f}, d.anisotropic = {0.5f}; });
  add("thin", 0.1f,
      [](D& d) { d.eta = 0.7f, d.spec_tint = {0.3f}, d.metallic = {0.4f}, d.roughness = {0.5f}, d.clearcoat = {0.5f}; });
  add("all", 0.1f, [](D& d) {
    d.spec_trans = {0.3f}, d.eta = eta_of_specular(0.6f), d.roughness = {0.5f}, d.metallic = {0.3f}, d.anisotropic = {0.4f};
    d.spec_tint = {0.5f}, d.sheen = {0.5f}, d.sheen_tint = {0.6f}, d.flatness = {0.4f};
    d.clearcoat = {0.7f}, d.clearcoat_gloss = {0.2f};
  });
  return cases;
}

}  // namespace fluxfarm::testing
