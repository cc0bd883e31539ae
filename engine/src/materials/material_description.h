// Plain description of a material: what the scene file says, before any table is computed. No behaviour.
//
// A colour may vary over the surface: `..._texture` is an index into the scene's textures, whose value multiplies the constant.
#pragma once

#include <optional>
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

// A number that may vary over the surface: the luminance of the texture, if there is one, times the factor.
struct ScalarParameter {
  float factor = 0;
  int texture = kNoTexture;
};

// Burley's principled material. All numbers in [0, 1] but eta, which is positive.
struct PrincipledDescription {
  Rgb base_color{0.5f};
  int base_color_texture = kNoTexture;
  ScalarParameter roughness{0.5f};  // its square is the alpha of the microfacets
  ScalarParameter anisotropic, metallic, spec_trans, spec_tint, sheen, sheen_tint, flatness, clearcoat, clearcoat_gloss;
  float eta = 1.5f;  // interior over exterior index of refraction
};

// glTF 2.0's metallic-roughness model with the KHR extensions specular, ior, transmission, clearcoat, sheen and anisotropy.
// Scatters on both sides. Texture channels as glTF has them: metallic B, roughness G; transmission R, clear coat R and its
// roughness G; colours RGB. Those of specular and sheen_roughness are grey: the reader takes them from their alpha. Each
// multiplies its constant.
struct GltfDescription {
  Rgb base_color{1.0f};
  bool vertex_colors = false;  // the colours of the mesh's vertices multiply the base colour
  float metallic = 1;
  float roughness = 1;  // perceptual: the GGX alpha is its square
  float ior = 1.5f;     // interior over exterior; 0 reflects all at every angle
  float specular = 1;   // of the dielectric part
  Rgb specular_color{1.0f};
  float transmission = 0;         // share of what would be diffuse
  bool thin = true;               // transmits without refraction, as a pane; else it bounds a volume on the side of -z
  float anisotropy = 0;           // [0,1], rougher along the tangent
  float anisotropy_rotation = 0;  // radians, from the tangent towards the bitangent
  float clearcoat = 0;
  float clearcoat_roughness = 0;
  Rgb sheen_color{0.0f};
  float sheen_roughness = 0;
  int base_color_texture = kNoTexture;
  int metallic_roughness_texture = kNoTexture;
  int transmission_texture = kNoTexture;
  int specular_texture = kNoTexture;
  int specular_color_texture = kNoTexture;
  int clearcoat_texture = kNoTexture;
  int clearcoat_roughness_texture = kNoTexture;
  int sheen_color_texture = kNoTexture;
  int sheen_roughness_texture = kNoTexture;
};

// Front and back are indices into the same list of materials; neither may transmit light.
struct TwosidedDescription {
  int front = 0;
  int back = 0;
};

// A pane: a dielectric on both sides of nothing.
struct ThinDielectricDescription {
  DielectricDescription dielectric;
};

// No surface at all: light passes straight through. Bounds a medium.
struct NullDescription {};

// The materials that these hold are indices into the same list.

// `opacity` in [0, 1] is covered by the material; the rest passes. With a cut-off all is covered where the opacity reaches it, and
// nothing elsewhere.
struct MaskDescription {
  int material = 0;
  ScalarParameter opacity{0.5f};
  std::optional<float> cutoff{};
};

// (1 - weight) of the first, weight of the second.
struct BlendDescription {
  int first = 0;
  int second = 0;
  ScalarParameter weight{0.5f};
};

// Normals are 2 rgb - 1 with x and y times `scale`, in the frame of the surface: x along increasing u, y across x and the normal,
// or, with `y_against_v`, on the side of decreasing v, which is another one where the texture lies mirrored.
struct NormalMapDescription {
  int material = 0;
  int normals_texture = 0;
  float scale = 1;
  bool y_against_v = false;
};

// Height is scale times the luminance of the texture, m.
struct BumpMapDescription {
  int material = 0;
  int height_texture = 0;
  float scale = 1;
};

using MaterialDescription =
    std::variant<DiffuseDescription, DielectricDescription, ConductorDescription, RoughConductorDescription,
                 RoughDielectricDescription, PlasticDescription, RoughPlasticDescription, PrincipledDescription, GltfDescription,
                 TwosidedDescription, ThinDielectricDescription, NullDescription, MaskDescription, BlendDescription,
                 NormalMapDescription, BumpMapDescription>;

}  // namespace fluxfarm
