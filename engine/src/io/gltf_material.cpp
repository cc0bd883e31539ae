#include "io/gltf_material.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/emission_limits.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

// Below this contrast refraction bends nothing that single precision could tell.
constexpr float kNoContrast = 1e-4f;
constexpr float kSmoothRoughness = 1e-2f;  // alpha 1e-4, the narrowest lobe

Rgb rgb(const std::vector<double>& values) {
  return {static_cast<float>(values[0]), static_cast<float>(values[1]), static_cast<float>(values[2])};
}

float number(const GltfObject& object, const char* name, double otherwise, NumberRange range = kUnitInterval) {
  return static_cast<float>(object.number(name, otherwise, range));
}

// A dielectric and nothing else: an existing material, with exact Fresnel reflectances and smooth when it says so.
bool is_pure_glass(const GltfDescription& d) {
  const bool varies = d.vertex_colors || d.base_color_texture != kNoTexture || d.metallic_roughness_texture != kNoTexture ||
                      d.transmission_texture != kNoTexture || d.specular_texture != kNoTexture ||
                      d.specular_color_texture != kNoTexture;
  return !d.thin && !varies && d.transmission == 1 && d.metallic == 0 && d.specular == 1 && d.specular_color == Rgb{1} &&
         d.clearcoat == 0 && d.sheen_color.is_black() && d.anisotropy == 0;
}

MaterialDescription glass(const GltfDescription& d) {
  DielectricDescription dielectric;
  dielectric.eta = d.ior;
  dielectric.specular_transmittance = d.base_color;
  if (d.roughness < kSmoothRoughness) return dielectric;
  return RoughDielectricDescription{
      dielectric, {MicrofacetDistribution::kGgx, d.roughness * d.roughness, d.roughness * d.roughness, kNoTexture}};
}

}  // namespace

// Reads one material object.
class GltfMaterials::Reader {
 public:
  Reader(const GltfObject& material, GltfTextures& textures, SceneDescription& scene)
      : material_(material), textures_(textures), scene_(scene) {}

  Known read() {
    read_metallic_roughness();
    read_layers();
    read_transmission();
    read_alpha();
    read_normal_map();
    read_emission();
    read_unlit();
    result_.material.double_sided = material_.boolean("doubleSided", false);
    result_.material.uv_set = uv_set_.value_or(0);
    return result_;
  }

 private:
  void warn(const std::string& what) { scene_.warnings.push_back(material_.place() + ": " + what); }

  void texture(const GltfObject& object, const char* name, GltfChannels channels, int& index) {
    const std::optional<GltfTextures::Use> use = textures_.read(object, name, channels);
    if (!use) return;
    if (uv_set_ && *uv_set_ != use->uv_set)
      warn(std::string(name) + " asks for TEXCOORD_" + std::to_string(use->uv_set) + "; TEXCOORD_" + std::to_string(*uv_set_) +
           ", which a texture before it asks for, is used");
    if (!uv_set_) uv_set_ = use->uv_set;
    index = use->texture;
  }

  void left_out(const GltfObject& object, const char* name, const char* why) {
    if (object.has(name)) warn(std::string(name) + " is left out: " + why);
  }

  void read_metallic_roughness() {
    const std::optional<GltfObject> pbr = material_.object("pbrMetallicRoughness");
    if (!pbr) return;
    d_.base_color = rgb(pbr->numbers("baseColorFactor", 4, {1, 1, 1, 1}, kUnitInterval));
    d_.metallic = number(*pbr, "metallicFactor", 1);
    d_.roughness = number(*pbr, "roughnessFactor", 1);
    texture(*pbr, "baseColorTexture", GltfChannels::kColors, d_.base_color_texture);
    texture(*pbr, "metallicRoughnessTexture", GltfChannels::kNumbers, d_.metallic_roughness_texture);
  }

  void read_layers() {
    if (const auto ior = material_.extension("KHR_materials_ior")) {
      d_.ior = number(*ior, "ior", 1.5, kNotNegative);
      if (d_.ior != 0 && d_.ior < 1) ior->fail("ior", "expected 0 or a number of at least 1");
    }
    if (const auto specular = material_.extension("KHR_materials_specular")) {
      d_.specular = number(*specular, "specularFactor", 1);
      d_.specular_color = rgb(specular->numbers("specularColorFactor", 3, {1, 1, 1}, kNotNegative));
      texture(*specular, "specularColorTexture", GltfChannels::kColors, d_.specular_color_texture);
      texture(*specular, "specularTexture", GltfChannels::kAlpha, d_.specular_texture);
    }
    if (const auto coat = material_.extension("KHR_materials_clearcoat")) {
      d_.clearcoat = number(*coat, "clearcoatFactor", 0);
      d_.clearcoat_roughness = number(*coat, "clearcoatRoughnessFactor", 0);
      texture(*coat, "clearcoatTexture", GltfChannels::kNumbers, d_.clearcoat_texture);
      texture(*coat, "clearcoatRoughnessTexture", GltfChannels::kNumbers, d_.clearcoat_roughness_texture);
      left_out(*coat, "clearcoatNormalTexture", "the coat has the normals of its base");
    }
    if (const auto sheen = material_.extension("KHR_materials_sheen")) {
      d_.sheen_color = rgb(sheen->numbers("sheenColorFactor", 3, {0, 0, 0}, kUnitInterval));
      d_.sheen_roughness = number(*sheen, "sheenRoughnessFactor", 0);
      texture(*sheen, "sheenColorTexture", GltfChannels::kColors, d_.sheen_color_texture);
      texture(*sheen, "sheenRoughnessTexture", GltfChannels::kAlpha, d_.sheen_roughness_texture);
    }
    if (const auto anisotropy = material_.extension("KHR_materials_anisotropy")) {
      d_.anisotropy = number(*anisotropy, "anisotropyStrength", 0);
      d_.anisotropy_rotation = number(*anisotropy, "anisotropyRotation", 0, kAnyNumber);
      left_out(*anisotropy, "anisotropyTexture", "directions from textures are not read");
    }
  }

  void read_transmission() {
    const auto transmission = material_.extension("KHR_materials_transmission");
    if (transmission) {
      d_.transmission = number(*transmission, "transmissionFactor", 0);
      texture(*transmission, "transmissionTexture", GltfChannels::kNumbers, d_.transmission_texture);
    }
    const auto volume = material_.extension("KHR_materials_volume");
    if (!volume || d_.transmission == 0) return;
    const float thickness = number(*volume, "thicknessFactor", 0, kNotNegative);
    if (thickness == 0) return;
    d_.thin = std::abs(d_.ior - 1) < kNoContrast;
    read_attenuation(*volume);
  }

  // The medium behind the surface, which absorbs and does not scatter.
  void read_attenuation(const GltfObject& volume) {
    const double distance = volume.number("attenuationDistance", std::numeric_limits<double>::infinity(), kPositive);
    const std::vector<double> color = volume.numbers("attenuationColor", 3, {1, 1, 1}, kUnitInterval);
    // Beer's law: the colour is what is left after the distance, in m of the world. 0 lets nothing through; 1e-6 is as black.
    const auto absorption = [&](std::size_t i) { return static_cast<float>(std::log(1 / std::max(color[i], 1e-6)) / distance); };
    const Rgb sigma_a{absorption(0), absorption(1), absorption(2)};
    if (!is_finite(sigma_a)) volume.fail("attenuationDistance", "with it the absorption is infinite, expected a larger number");
    if (sigma_a.is_black()) return;
    result_.material.interior_medium = static_cast<int>(scene_.media.size());
    scene_.media.push_back({.sigma_t = sigma_a, .albedo = Rgb{0}});
  }

  void read_emission() {
    Rgb emitted = rgb(material_.numbers("emissiveFactor", 3, {0, 0, 0}, kNotNegative));
    if (const auto strength = material_.extension("KHR_materials_emissive_strength"))
      emitted *= number(*strength, "emissiveStrength", 1, kNotNegative);
    if (emitted.is_black()) return;
    if (const auto use = textures_.read(material_, "emissiveTexture", GltfChannels::kColors)) {
      emitted *= textures_.mean(use->texture);
      warn("emissiveTexture: the light has the mean colour of the texture all over");
    }
    if (!is_within_emission_limits(emitted)) {
      material_.fail("emissiveFactor", std::string(kEmissionExpected) + ", with emissiveStrength and emissiveTexture");
    }
    if (emitted.is_black()) return;
    result_.material.emitted_radiance = emitted;
    if (result_.mask) warn("alphaMode: the light shines in full where the surface is transparent, too");
  }

  // Opacity: the alpha of the base colour.                                                                [glTF, 3.9.4]
  void read_alpha() {
    const std::string mode = material_.text("alphaMode", "OPAQUE");
    if (mode != "OPAQUE" && mode != "MASK" && mode != "BLEND") material_.fail("alphaMode", "expected OPAQUE, MASK or BLEND");
    const float cutoff = number(material_, "alphaCutoff", 0.5, kNotNegative);
    if (mode == "OPAQUE") return;
    result_.material.has_alpha = true;
    MaskDescription mask;
    mask.opacity.factor = 1;
    if (const auto pbr = material_.object("pbrMetallicRoughness")) {
      mask.opacity.factor = static_cast<float>(pbr->numbers("baseColorFactor", 4, {1, 1, 1, 1}, kUnitInterval)[3]);
      texture(*pbr, "baseColorTexture", GltfChannels::kAlpha, mask.opacity.texture);
    }
    if (mode == "MASK") mask.cutoff = cutoff;
    const bool opaque = mask.opacity.texture == kNoTexture && mask.opacity.factor >= mask.cutoff.value_or(1);
    if (!opaque) result_.mask = mask;
  }

  // +y points up in the image, against v; the scale acts on x and y.                                     [glTF, 3.9.3]
  void read_normal_map() {
    NormalMapDescription map;
    map.y_against_v = true;
    map.normals_texture = kNoTexture;
    texture(material_, "normalTexture", GltfChannels::kNumbers, map.normals_texture);
    if (map.normals_texture == kNoTexture) return;
    const GltfObject info = material_.required_object("normalTexture");
    map.scale = number(info, "scale", 1, kAnyNumber);
    if (!std::isfinite(map.scale)) info.fail("scale", "expected a smaller number");
    result_.normal_map = map;
  }

  void read_unlit() {
    if (!material_.extension("KHR_materials_unlit")) return;
    warn("KHR_materials_unlit: the surface is lit as a diffuse one");
    d_.metallic = 0;
    d_.roughness = 1;
    d_.specular = 0;
  }

  const GltfObject& material_;
  GltfTextures& textures_;
  SceneDescription& scene_;
  Known result_;
  GltfDescription& d_ = result_.surface;
  std::optional<int> uv_set_;
};

GltfMaterial GltfMaterials::of_primitive(const GltfObject& primitive) {
  const std::optional<std::size_t> index = primitive.index("material", "materials", file_.size("materials"));
  auto known = known_.find(index);
  // What glTF gives a primitive without material: all defaults.
  if (known == known_.end())
    known = known_.emplace(index, index ? Reader(file_.at("materials", *index), textures_, scene_).read() : Known{}).first;
  const bool vertex_colors = primitive.required_object("attributes").has("COLOR_0");
  std::optional<int>& made = vertex_colors ? known->second.colored : known->second.plain;
  if (!made) made = add(known->second, vertex_colors);
  GltfMaterial material = known->second.material;
  material.index = *made;
  return material;
}

int GltfMaterials::add(Known known, bool vertex_colors) {
  known.surface.vertex_colors = vertex_colors;
  int index = add(is_pure_glass(known.surface) ? glass(known.surface) : known.surface);
  if (known.normal_map) {
    known.normal_map->material = index;
    index = add(*known.normal_map);
  }
  if (known.mask) {
    known.mask->material = index;
    index = add(*known.mask);
  }
  return index;
}

int GltfMaterials::add(const MaterialDescription& material) {
  scene_.materials.push_back(material);
  return static_cast<int>(scene_.materials.size()) - 1;
}

}  // namespace fluxfarm
