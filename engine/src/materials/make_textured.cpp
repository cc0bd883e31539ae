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

// Makes each material after those that it holds. That none contains itself was checked when the Bsdfs were made.
class Maker {
 public:
  Maker(const std::vector<MaterialDescription>& descriptions, const std::vector<std::unique_ptr<Bsdf>>& bsdfs,
        const Textures& textures)
      : textures_(textures), descriptions_(descriptions), bsdfs_(bsdfs), is_made_(bsdfs.size()), made_(bsdfs.size()) {}

  std::vector<Result> make_all() {
    for (std::size_t i = 0; i < descriptions_.size(); ++i) make(i);
    return std::move(made_);
  }

  Result operator()(const DiffuseDescription& d) const {
    return make_reflecting(base(), texture_of(textures_, d.reflectance_texture));
  }
  Result operator()(const ConductorDescription& d) const {
    return make_reflecting(base(), texture_of(textures_, d.specular_reflectance_texture));
  }
  Result operator()(const RoughConductorDescription& d) const {
    if (d.roughness.alpha_texture != kNoTexture) return make_textured_rough_conductor(d, textures_);
    return make_reflecting(base(), texture_of(textures_, d.conductor.specular_reflectance_texture));
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
  Result operator()(const PlasticDescription& d) const { return has_texture(d) ? make_textured_plastic(d, textures_) : nullptr; }
  Result operator()(const RoughPlasticDescription& d) const {
    return has_texture(d.plastic) ? make_textured_rough_plastic(d, textures_) : nullptr;
  }
  Result operator()(const PrincipledDescription& d) const {
    return has_texture(d) ? make_textured_principled(d, textures_) : nullptr;
  }
  Result operator()(const GltfDescription& d) const { return make_textured_gltf(d, textures_); }
  Result operator()(const ThinDielectricDescription& d) const {
    const TintedDescription tinted = tinted_dielectric(d.dielectric);
    if (tinted.reflected == nullptr && tinted.transmitted == nullptr) return nullptr;
    return make_tinted(tinted, make_thin_dielectric({without_transmission(d.dielectric)}),
                       make_thin_dielectric({without_reflection(d.dielectric)}));
  }
  Result operator()(const NullDescription&) const { return nullptr; }
  Result operator()(const TwosidedDescription& d) {
    const NestedMaterial front = held(d.front), back = held(d.back);
    return front.textured != nullptr || back.textured != nullptr ? make_textured_twosided(front, back) : nullptr;
  }
  Result operator()(const MaskDescription& d) {
    const NestedMaterial covered = held(d.material);
    const TexturedScalar opacity = scalar(d.opacity);
    return covered.textured != nullptr || opacity.texture != nullptr ? make_textured_mask(covered, opacity, d.cutoff) : nullptr;
  }
  Result operator()(const BlendDescription& d) {
    const NestedMaterial first = held(d.first), second = held(d.second);
    const TexturedScalar weight = scalar(d.weight);
    const bool varies = first.textured != nullptr || second.textured != nullptr || weight.texture != nullptr;
    return varies ? make_textured_blend(first, second, weight) : nullptr;
  }
  Result operator()(const NormalMapDescription& d) {
    return make_normal_map(held(d.material), *texture_of(textures_, d.normals_texture), d);
  }
  Result operator()(const BumpMapDescription& d) {
    return make_bump_map(held(d.material), *texture_of(textures_, d.height_texture), d.scale);
  }

 private:
  TintedDescription tinted_dielectric(const DielectricDescription& d) const {
    return {&base(), texture_of(textures_, d.specular_reflectance_texture),
            texture_of(textures_, d.specular_transmittance_texture)};
  }
  static bool has_texture(const PrincipledDescription& d) {
    if (d.base_color_texture != kNoTexture) return true;
    for (const ScalarParameter* p : {&d.roughness, &d.anisotropic, &d.metallic, &d.spec_trans, &d.spec_tint, &d.sheen,
                                     &d.sheen_tint, &d.flatness, &d.clearcoat, &d.clearcoat_gloss}) {
      if (p->texture != kNoTexture) return true;
    }
    return false;
  }
  static bool has_texture(const PlasticDescription& d) {
    return d.diffuse_reflectance_texture != kNoTexture || d.specular_reflectance_texture != kNoTexture;
  }

  void make(std::size_t i) {
    if (is_made_[i]) return;
    const std::size_t outer = current_;
    current_ = i;
    made_[i] = std::visit(*this, descriptions_[i]);
    current_ = outer;
    is_made_[i] = true;
    if (made_[i] == nullptr) return;
    BsdfSpace space;
    made_[i]->at({}, space);  // that there is room for it
  }

  const Bsdf& base() const { return *bsdfs_[current_]; }
  NestedMaterial held(int index) {
    const auto i = static_cast<std::size_t>(index);
    make(i);
    return {bsdfs_[i].get(), made_[i].get()};
  }
  TexturedScalar scalar(const ScalarParameter& p) const { return {p.factor, texture_of(textures_, p.texture)}; }

  const Textures& textures_;
  const std::vector<MaterialDescription>& descriptions_;
  const std::vector<std::unique_ptr<Bsdf>>& bsdfs_;
  std::vector<bool> is_made_;
  std::vector<Result> made_;
  std::size_t current_ = 0;
};

}  // namespace

std::vector<std::unique_ptr<TexturedMaterial>> make_textured_materials(const std::vector<MaterialDescription>& descriptions,
                                                                       const std::vector<std::unique_ptr<Bsdf>>& bsdfs,
                                                                       const Textures& textures) {
  return Maker(descriptions, bsdfs, textures).make_all();
}

}  // namespace fluxfarm
