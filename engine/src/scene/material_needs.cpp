#include "scene/material_needs.h"

namespace fluxfarm {
namespace {

class Collector {
 public:
  explicit Collector(const SceneDescription& scene) : scene_(scene) {}

  void visit(std::size_t material) { std::visit(*this, scene_.materials[material]); }
  const MaterialNeeds& needs() const { return needs_; }

  void operator()(const DiffuseDescription& d) { texture(d.reflectance_texture); }
  void operator()(const DielectricDescription& d) {
    needs_.delta_lobes = needs_.glossy = true;
    textures(d);
  }
  void operator()(const ConductorDescription& d) {
    needs_.delta_lobes = needs_.glossy = true;
    texture(d.specular_reflectance_texture);
  }
  void operator()(const RoughConductorDescription& d) {
    needs_.glossy = true;
    texture(d.conductor.specular_reflectance_texture);
    roughness(d.roughness);
  }
  void operator()(const RoughDielectricDescription& d) {
    needs_.glossy = true;
    textures(d.dielectric);
    roughness(d.roughness);
  }
  void operator()(const PlasticDescription& d) {
    needs_.delta_lobes = needs_.glossy = true;
    textures(d);
  }
  void operator()(const RoughPlasticDescription& d) {
    needs_.glossy = true;
    textures(d.plastic);
  }
  void operator()(const PrincipledDescription& d) {
    needs_.glossy = true;
    texture(d.base_color_texture);
    for (const ScalarParameter* p : {&d.roughness, &d.anisotropic, &d.metallic, &d.spec_trans, &d.spec_tint, &d.sheen,
                                     &d.sheen_tint, &d.flatness, &d.clearcoat, &d.clearcoat_gloss}) {
      texture(p->texture);
    }
    needs_.anisotropic |= d.anisotropic.factor > 0;
    needs_.tangents |= needs_.anisotropic;
  }
  void operator()(const GltfDescription& d) {
    needs_.glossy = true;
    for (const int index :
         {d.base_color_texture, d.metallic_roughness_texture, d.transmission_texture, d.specular_texture, d.specular_color_texture,
          d.clearcoat_texture, d.clearcoat_roughness_texture, d.sheen_color_texture, d.sheen_roughness_texture}) {
      texture(index);
    }
    needs_.vertex_colors |= d.vertex_colors;
    needs_.anisotropic |= d.anisotropy > 0;
    needs_.tangents |= needs_.anisotropic;
  }
  void operator()(const TwosidedDescription& d) {
    held(d.front);
    held(d.back);
  }
  void operator()(const ThinDielectricDescription& d) { (*this)(d.dielectric); }
  void operator()(const NullDescription&) { needs_.masks = true; }
  void operator()(const MaskDescription& d) {
    needs_.masks = true;
    texture(d.opacity.texture);
    held(d.material);
  }
  void operator()(const BlendDescription& d) {
    texture(d.weight.texture);
    held(d.first);
    held(d.second);
  }
  void operator()(const NormalMapDescription& d) {
    needs_.glossy = needs_.normal_maps = needs_.tangents = true;
    needs_.uv_derivatives |= d.y_against_v;
    texture(d.normals_texture);
    held(d.material);
  }
  void operator()(const BumpMapDescription& d) {
    needs_.glossy = needs_.normal_maps = needs_.tangents = needs_.uv_derivatives = true;
    texture(d.height_texture);
    held(d.material);
  }

 private:
  void held(int material) { visit(static_cast<std::size_t>(material)); }

  void roughness(const Roughness& r) {
    needs_.anisotropic |= r.alpha_u != r.alpha_v;
    needs_.tangents |= needs_.anisotropic;
    texture(r.alpha_texture);
  }

  void textures(const DielectricDescription& d) {
    texture(d.specular_reflectance_texture);
    texture(d.specular_transmittance_texture);
  }
  void textures(const PlasticDescription& d) {
    texture(d.diffuse_reflectance_texture);
    texture(d.specular_reflectance_texture);
  }

  void texture(int index) {
    if (index == kNoTexture) return;
    const bool of_vertices = std::holds_alternative<MeshAttributeDescription>(scene_.textures[static_cast<std::size_t>(index)]);
    (of_vertices ? needs_.vertex_colors : needs_.uvs) = true;
  }

  const SceneDescription& scene_;
  MaterialNeeds needs_;
};

}  // namespace

MaterialNeeds material_needs(const SceneDescription& scene, std::size_t material) {
  Collector collector(scene);
  collector.visit(material);
  return collector.needs();
}

}  // namespace fluxfarm
