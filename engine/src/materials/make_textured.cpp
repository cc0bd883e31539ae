#include "materials/make_textured.h"

#include "materials/bsdf_factories.h"
#include "materials/textured_factories.h"
#include "materials/tinted.h"

namespace fluxfarm {
namespace {

using Result = std::unique_ptr<TexturedMaterial>;

Result make_reflecting(const Bsdf& base, const Texture* reflected) {
  return reflected != nullptr ? make_tinted({&base, reflected, nullptr}, nullptr, nullptr) : nullptr;
}

DielectricDescription without_transmission(DielectricDescription d) {
  d.specular_transmittance = Rgb{0.0f};
  return d;
}
DielectricDescription without_reflection(DielectricDescription d) {
  d.specular_reflectance = Rgb{0.0f};
  return d;
}

struct Maker {
  const Bsdf& base;
  const Textures& textures;

  Result operator()(const DiffuseDescription& d) const {
    return make_reflecting(base, texture_of(textures, d.reflectance_texture));
  }
  Result operator()(const ConductorDescription& d) const {
    return make_reflecting(base, texture_of(textures, d.specular_reflectance_texture));
  }
  Result operator()(const RoughConductorDescription& d) const {
    if (d.roughness.alpha_texture != kNoTexture) return make_textured_rough_conductor(d, textures);
    return make_reflecting(base, texture_of(textures, d.conductor.specular_reflectance_texture));
  }
  Result operator()(const DielectricDescription& d) const {
    const TintedDescription tinted = tinted_dielectric(d);
    if (tinted.reflected == nullptr && tinted.transmitted == nullptr) return nullptr;
    return make_tinted(tinted, make_dielectric(without_transmission(d)), make_dielectric(without_reflection(d)));
  }
  Result operator()(const RoughDielectricDescription& d) const {
    const TintedDescription tinted = tinted_dielectric(d.dielectric);
    if (tinted.reflected == nullptr && tinted.transmitted == nullptr) return nullptr;
    return make_tinted(tinted, make_rough_dielectric({without_transmission(d.dielectric), d.roughness}),
                       make_rough_dielectric({without_reflection(d.dielectric), d.roughness}));
  }
  Result operator()(const PlasticDescription& d) const { return has_texture(d) ? make_textured_plastic(d, textures) : nullptr; }
  Result operator()(const RoughPlasticDescription& d) const {
    return has_texture(d.plastic) ? make_textured_rough_plastic(d, textures) : nullptr;
  }
  Result operator()(const GltfDescription& d) const { return make_textured_gltf(d, textures); }
  Result operator()(const TwosidedDescription&) const { return nullptr; }

  TintedDescription tinted_dielectric(const DielectricDescription& d) const {
    return {&base, texture_of(textures, d.specular_reflectance_texture), texture_of(textures, d.specular_transmittance_texture)};
  }
  static bool has_texture(const PlasticDescription& d) {
    return d.diffuse_reflectance_texture != kNoTexture || d.specular_reflectance_texture != kNoTexture;
  }
};

}  // namespace

std::vector<std::unique_ptr<TexturedMaterial>> make_textured_materials(const std::vector<MaterialDescription>& descriptions,
                                                                       const std::vector<std::unique_ptr<Bsdf>>& bsdfs,
                                                                       const Textures& textures) {
  std::vector<Result> result;
  result.reserve(descriptions.size());
  for (std::size_t i = 0; i < descriptions.size(); ++i) {
    result.push_back(std::visit(Maker{*bsdfs[i], textures}, descriptions[i]));
  }
  return result;
}

}  // namespace fluxfarm
