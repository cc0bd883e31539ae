// Plain description of a material: what the scene file says, before any table is computed. No behaviour.
//
// A colour may vary over the surface: `..._texture` is an index into the scene's textures, whose value multiplies the constant.
#pragma once

#include <variant>

#include "math/rgb.h"

namespace fluxfarm {

inline constexpr int kNoTexture = -1;

struct DiffuseDescription {
  Rgb reflectance{0.5f};
  int reflectance_texture = kNoTexture;
};

struct DielectricDescription {
  float eta = 1.5046f / 1.000277f;  // interior over exterior index of refraction
  Rgb specular_reflectance{1.0f};
  Rgb specular_transmittance{1.0f};
  int specular_reflectance_texture = kNoTexture;
  int specular_transmittance_texture = kNoTexture;
};

// Complex index of refraction eta - i k, relative to the exterior. `perfect` ignores it and reflects everything.
struct ConductorDescription {
  bool perfect = false;
  Rgb eta{0.0f};
  Rgb k{1.0f};
  Rgb specular_reflectance{1.0f};
  int specular_reflectance_texture = kNoTexture;
};

enum class MicrofacetDistribution { kBeckmann, kGgx };

// Roughness along the two tangents; > 0. The luminance of a texture multiplies both: of roughconductor only.
struct Roughness {
  MicrofacetDistribution distribution = MicrofacetDistribution::kBeckmann;
  float alpha_u = 0.1f;
  float alpha_v = 0.1f;
  int alpha_texture = kNoTexture;
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
  int diffuse_reflectance_texture = kNoTexture;
  int specular_reflectance_texture = kNoTexture;
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

// No surface at all: light passes straight through. Bounds a medium.
struct NullDescription {};

using MaterialDescription =
    std::variant<DiffuseDescription, DielectricDescription, ConductorDescription, RoughConductorDescription,
                 RoughDielectricDescription, PlasticDescription, RoughPlasticDescription, TwosidedDescription, NullDescription>;

}  // namespace fluxfarm
