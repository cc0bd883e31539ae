// Plain description of a material: what the scene file says, before any table is computed. No behaviour.
#pragma once

#include <variant>

#include "math/rgb.h"

namespace fluxfarm {

struct DiffuseDescription {
  Rgb reflectance{0.5f};
};

struct DielectricDescription {
  float eta = 1.5046f / 1.000277f;  // interior over exterior index of refraction
  Rgb specular_reflectance{1.0f};
  Rgb specular_transmittance{1.0f};
};

// Complex index of refraction eta - i k, relative to the exterior. `perfect` ignores it and reflects everything.
struct ConductorDescription {
  bool perfect = false;
  Rgb eta{0.0f};
  Rgb k{1.0f};
  Rgb specular_reflectance{1.0f};
};

enum class MicrofacetDistribution { kBeckmann, kGgx };

// Roughness along the two tangents; > 0.
struct Roughness {
  MicrofacetDistribution distribution = MicrofacetDistribution::kBeckmann;
  float alpha_u = 0.1f;
  float alpha_v = 0.1f;
};

struct RoughConductorDescription {
  ConductorDescription conductor;
  Roughness roughness;
};

struct RoughDielectricDescription {
  DielectricDescription dielectric;
  Roughness roughness;
};

// Diffuse base under a smooth dielectric coat. `nonlinear`: colour shifts by internal scattering are kept.
struct PlasticDescription {
  float eta = 1.49f / 1.000277f;
  Rgb diffuse_reflectance{0.5f};
  Rgb specular_reflectance{1.0f};
  bool nonlinear = false;
};

struct RoughPlasticDescription {
  PlasticDescription plastic;
  Roughness roughness;  // isotropic: alpha_u = alpha_v
};

// Front and back are indices into the same list of materials; neither may transmit light.
struct TwosidedDescription {
  int front = 0;
  int back = 0;
};

using MaterialDescription =
    std::variant<DiffuseDescription, DielectricDescription, ConductorDescription, RoughConductorDescription,
                 RoughDielectricDescription, PlasticDescription, RoughPlasticDescription, TwosidedDescription>;

}  // namespace fluxfarm
