#include "io/gltf_material.h"

#include <algorithm>
#include <cmath>

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
  const bool textured = d.base_color_texture != kNoTexture || d.metallic_roughness_texture != kNoTexture ||
                        d.transmission_texture != kNoTexture || d.specular_color_texture != kNoTexture ||
                        d.clearcoat_texture != kNoTexture || d.sheen_color_texture != kNoTexture;
  return !d.thin && !textured && d.transmission == 1 && d.metallic == 0 && d.specular == 1 && d.specular_color == Rgb{1} &&
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
  Reader(const GltfObject& material, GltfTextures& textures, std::vector<std::string>& warnings)
      : material_(material), textures_(textures), warnings_(warnings) {}

  GltfMaterial read(std::vector<MaterialDescription>& materials) {
    read_metallic_roughness();
    read_layers();
    read_transmission();
    read_emission();
    warn_of_what_is_missing();
    result_.double_sided = material_.boolean("doubleSided", false);
    result_.uv_set = uv_set_.value_or(0);
    materials.push_back(is_pure_glass(d_) ? glass(d_) : d_);
    result_.index = static_cast<int>(materials.size()) - 1;
    return result_;
  }

 private:
  void warn(const std::string& what) { warnings_.push_back(material_.place() + ": " + what); }

  void texture(const GltfObject& object, const char* name, bool raw, int& index) {
    const std::optional<GltfTextures::Use> use = textures_.read(object, name, raw);
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
    texture(*pbr, "baseColorTexture", false, d_.base_color_texture);
    texture(*pbr, "metallicRoughnessTexture", true, d_.metallic_roughness_texture);
  }

  void read_layers() {
    if (const auto ior = material_.extension("KHR_materials_ior")) {
      d_.ior = number(*ior, "ior", 1.5, kNotNegative);
      if (d_.ior != 0 && d_.ior < 1) ior->fail("ior", "expected 0 or a number of at least 1");
    }
    if (const auto specular = material_.extension("KHR_materials_specular")) {
      d_.specular = number(*specular, "specularFactor", 1);
      d_.specular_color = rgb(specular->numbers("specularColorFactor", 3, {1, 1, 1}, kNotNegative));
      texture(*specular, "specularColorTexture", false, d_.specular_color_texture);
      left_out(*specular, "specularTexture", "alpha channels are not read");
    }
    if (const auto coat = material_.extension("KHR_materials_clearcoat")) {
      d_.clearcoat = number(*coat, "clearcoatFactor", 0);
      d_.clearcoat_roughness = number(*coat, "clearcoatRoughnessFactor", 0);
      texture(*coat, "clearcoatTexture", true, d_.clearcoat_texture);
      texture(*coat, "clearcoatRoughnessTexture", true, d_.clearcoat_roughness_texture);
      left_out(*coat, "clearcoatNormalTexture", "normal maps are not read");
    }
    if (const auto sheen = material_.extension("KHR_materials_sheen")) {
      d_.sheen_color = rgb(sheen->numbers("sheenColorFactor", 3, {0, 0, 0}, kUnitInterval));
      d_.sheen_roughness = number(*sheen, "sheenRoughnessFactor", 0);
      texture(*sheen, "sheenColorTexture", false, d_.sheen_color_texture);
      left_out(*sheen, "sheenRoughnessTexture", "alpha channels are not read");
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
      texture(*transmission, "transmissionTexture", true, d_.transmission_texture);
    }
    const auto volume = material_.extension("KHR_materials_volume");
    if (!volume || d_.transmission == 0) return;
    const float thickness = number(*volume, "thicknessFactor", 0, kNotNegative);
    if (thickness == 0) return;
    d_.thin = std::abs(d_.ior - 1) < kNoContrast;
    if (!volume->has("attenuationDistance")) return;
    const double distance = volume->number("attenuationDistance", 1, kPositive);
    const std::vector<double> color = volume->numbers("attenuationColor", 3, {1, 1, 1}, kUnitInterval);
    // Beer's law: the colour is what is left after the distance. No colour lets nothing through; 1e-6 is as black as that.
    const auto absorption = [&](std::size_t i) { return static_cast<float>(-std::log(std::max(color[i], 1e-6)) / distance); };
    const Rgb per_m{absorption(0), absorption(1), absorption(2)};
    if (per_m.is_black()) return;
    result_.absorption_per_m = per_m;
    warn("KHR_materials_volume: attenuation is not carried out yet; the volume is clear");
  }

  void read_emission() {
    Rgb emitted = rgb(material_.numbers("emissiveFactor", 3, {0, 0, 0}, kNotNegative));
    if (const auto strength = material_.extension("KHR_materials_emissive_strength"))
      emitted *= number(*strength, "emissiveStrength", 1, kNotNegative);
    if (emitted.is_black()) return;
    if (const auto use = textures_.read(material_, "emissiveTexture", false)) {
      emitted *= textures_.mean(use->texture);
      warn("emissiveTexture: the light has the mean colour of the texture all over");
    }
    if (!is_finite(emitted)) material_.fail("emissiveFactor", "with emissiveStrength it is infinite, expected a smaller number");
    if (!emitted.is_black()) result_.emitted_radiance = emitted;
  }

  void warn_of_what_is_missing() {
    left_out(material_, "normalTexture", "normal maps are not read");
    const std::string alpha = material_.text("alphaMode", "OPAQUE");
    if (alpha != "OPAQUE" && alpha != "MASK" && alpha != "BLEND") material_.fail("alphaMode", "expected OPAQUE, MASK or BLEND");
    if (alpha != "OPAQUE") warn("alphaMode " + alpha + " is not read; the surface is drawn opaque");
    if (material_.extension("KHR_materials_unlit")) {
      warn("KHR_materials_unlit: the surface is lit as a diffuse one");
      d_.metallic = 0;
      d_.roughness = 1;
      d_.specular = 0;
    }
  }

  const GltfObject& material_;
  GltfTextures& textures_;
  std::vector<std::string>& warnings_;
  GltfDescription d_;
  GltfMaterial result_;
  std::optional<int> uv_set_;
};

const GltfMaterial& GltfMaterials::of_primitive(const GltfObject& primitive) {
  const std::optional<std::size_t> index = primitive.index("material", "materials", file_.size("materials"));
  if (const auto known = known_.find(index); known != known_.end()) return known->second;
  if (index) return known_[index] = Reader(file_.at("materials", *index), textures_, warnings_).read(materials_);
  // What glTF gives a primitive without material: all defaults.
  GltfMaterial plain;
  materials_.emplace_back(GltfDescription{});
  plain.index = static_cast<int>(materials_.size()) - 1;
  return known_[index] = plain;
}

}  // namespace fluxfarm
