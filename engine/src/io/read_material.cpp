#include "io/read_material.h"

#include <algorithm>
#include <cmath>

#include "io/conductor_presets.h"
#include "io/named_ior.h"
#include "io/properties.h"
#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

// An index of refraction given as a number or by the name of a material.
float read_ior(Properties& properties, const std::string& name, const char* default_name) {
  const PropertyValue* value = properties.raw(name);
  const std::string* text = value ? std::get_if<std::string>(value) : nullptr;
  if (value && !text) return properties.number(name, 1, kPositive);
  const std::optional<float> ior = named_ior(text ? *text : default_name);
  if (!ior) properties.fail(name, "expected a number greater than 0 or one of: " + joined(ior_names()));
  return *ior;
}

float read_relative_ior(Properties& properties, const char* default_interior) {
  const float interior = read_ior(properties, "int_ior", default_interior);
  return interior / read_ior(properties, "ext_ior", "air");
}

// A colour that may be a texture: then its constant factor is 1 and `texture` its index.
Rgb read_colour(Properties& properties, TextureReader& textures, const std::string& name, Rgb otherwise, int& texture) {
  if (const PluginNode* node = properties.texture(name)) {
    texture = textures.read(*node);
    return Rgb(1);
  }
  return properties.rgb(name, otherwise, kUnitInterval);
}

DielectricDescription read_dielectric(Properties& properties, TextureReader& textures) {
  DielectricDescription result;
  result.eta = read_relative_ior(properties, "bk7");
  result.specular_reflectance =
      read_colour(properties, textures, "specular_reflectance", Rgb(1), result.specular_reflectance_texture);
  result.specular_transmittance =
      read_colour(properties, textures, "specular_transmittance", Rgb(1), result.specular_transmittance_texture);
  return result;
}

// Without eta, k and material it is a perfect mirror, as in Mitsuba.
ConductorDescription read_conductor(Properties& properties, TextureReader& textures) {
  ConductorDescription result;
  const std::string material = properties.text("material", "none");
  const bool explicit_index = properties.has("eta") || properties.has("k");
  if (material != "none") {
    if (explicit_index) properties.fail("material", "but eta or k are given, too; expected one or the other");
    const std::optional<ConductorPreset> preset = conductor_preset(material);
    if (!preset) properties.fail("material", "expected none or one of: " + joined(conductor_preset_names()));
    result.eta = preset->eta;
    result.k = preset->k;
  }
  result.perfect = material == "none" && !explicit_index;
  result.eta = properties.rgb("eta", result.eta, kNotNegative);
  result.k = properties.rgb("k", result.k, kNotNegative);
  // Not in Mitsuba 3: the medium outside, as `extEta` of 0.6. Its default there was air; here it is vacuum, as in Mitsuba 3.
  const float exterior = properties.has("ext_eta") ? read_ior(properties, "ext_eta", "vacuum") : 1.0f;
  result.eta = result.eta / exterior;
  result.k = result.k / exterior;
  result.specular_reflectance =
      read_colour(properties, textures, "specular_reflectance", Rgb(1), result.specular_reflectance_texture);
  return result;
}

PlasticDescription read_plastic(Properties& properties, TextureReader& textures) {
  PlasticDescription result;
  result.eta = read_relative_ior(properties, "polypropylene");
  result.diffuse_reflectance =
      read_colour(properties, textures, "diffuse_reflectance", Rgb(0.5f), result.diffuse_reflectance_texture);
  result.specular_reflectance =
      read_colour(properties, textures, "specular_reflectance", Rgb(1), result.specular_reflectance_texture);
  result.nonlinear = properties.boolean("nonlinear", false);
  return result;
}

Roughness read_roughness(Properties& properties, bool anisotropic) {
  constexpr float kSmallestAlpha = 1e-4f;  // Mitsuba raises smaller values to this, too
  Roughness result;
  const std::string distribution = properties.text("distribution", "beckmann");
  if (distribution != "beckmann" && distribution != "ggx") properties.fail("distribution", "expected beckmann or ggx");
  result.distribution = distribution == "ggx" ? MicrofacetDistribution::kGgx : MicrofacetDistribution::kBeckmann;
  properties.ignore({"sample_visible"});

  const float alpha = properties.number("alpha", 0.1f, kUnitInterval);
  result.alpha_u = result.alpha_v = alpha;
  if (anisotropic) {
    if (properties.has("alpha_u") != properties.has("alpha_v"))
      properties.fail("alpha", "alpha_u and alpha_v must be given together");
    if (properties.has("alpha") && properties.has("alpha_u")) properties.fail("alpha", "but alpha_u and alpha_v are given, too");
    result.alpha_u = properties.number("alpha_u", alpha, kUnitInterval);
    result.alpha_v = properties.number("alpha_v", alpha, kUnitInterval);
  }
  result.alpha_u = std::max(result.alpha_u, kSmallestAlpha);
  result.alpha_v = std::max(result.alpha_v, kSmallestAlpha);
  return result;
}

RoughConductorDescription read_rough_conductor(Properties& properties, TextureReader& textures) {
  RoughConductorDescription result{read_conductor(properties, textures), {}};
  const PluginNode* alpha = properties.texture("alpha");
  result.roughness = read_roughness(properties, true);
  if (alpha == nullptr) return result;
  if (properties.has("alpha_u")) properties.fail("alpha_u", "but alpha is given, too, as a texture");
  result.roughness.alpha_u = result.roughness.alpha_v = 1;
  result.roughness.alpha_texture = textures.read(*alpha);
  return result;
}

MaterialDescription read_simple(const PluginNode& node, TextureReader& textures) {
  Properties properties(node);
  MaterialDescription result;
  if (node.type == "diffuse") {
    DiffuseDescription diffuse;
    diffuse.reflectance = read_colour(properties, textures, "reflectance", Rgb(0.5f), diffuse.reflectance_texture);
    result = diffuse;
  } else if (node.type == "null") {
    result = NullDescription{};
  } else if (node.type == "dielectric") {
    result = read_dielectric(properties, textures);
  } else if (node.type == "roughdielectric") {
    const DielectricDescription dielectric = read_dielectric(properties, textures);
    if (dielectric.eta == 1)
      throw SceneError(node.place, title(node) + ": int_ior and ext_ior are equal, expected two different ones");
    result = RoughDielectricDescription{dielectric, read_roughness(properties, true)};
  } else if (node.type == "conductor") {
    result = read_conductor(properties, textures);
  } else if (node.type == "roughconductor") {
    result = read_rough_conductor(properties, textures);
  } else if (node.type == "plastic") {
    result = read_plastic(properties, textures);
  } else {
    result = RoughPlasticDescription{read_plastic(properties, textures), read_roughness(properties, false)};
  }
  properties.finish();
  properties.finish_textures();
  return result;
}

bool transmits(const MaterialDescription& material) {
  return std::holds_alternative<DielectricDescription>(material) || std::holds_alternative<RoughDielectricDescription>(material) ||
         std::holds_alternative<NullDescription>(material);
}

}  // namespace

int MaterialReader::read(const PluginNode& bsdf_or_reference) {
  const PluginNode& node = bsdf_or_reference.kind == PluginKind::kReference
                               ? referenced(bsdf_or_reference, PluginKind::kBsdf, plugins_)
                               : bsdf_or_reference;
  if (const auto known = indices_.find(&node); known != indices_.end()) return known->second;
  if (!being_read_.insert(&node).second) throw SceneError(bsdf_or_reference.place, title(node) + " contains itself");
  const MaterialDescription material = node.type == "twosided" ? read_twosided(node) : read_simple(node, textures_);
  being_read_.erase(&node);
  materials_.push_back(material);
  return indices_[&node] = static_cast<int>(materials_.size()) - 1;
}

int MaterialReader::diffuse(float reflectance) {
  const auto [found, is_new] = greys_.emplace(reflectance, static_cast<int>(materials_.size()));
  if (is_new) materials_.push_back(DiffuseDescription{Rgb(reflectance)});
  return found->second;
}

MaterialDescription MaterialReader::read_twosided(const PluginNode& node) {
  Properties(node).finish();
  std::vector<int> sides;
  for (const PluginNode& child : node.children) {
    if (child.kind != PluginKind::kBsdf && child.kind != PluginKind::kReference) fail_nested(node, child, "one or two bsdfs");
    int side = read(child);
    const MaterialDescription& material = materials_[static_cast<std::size_t>(side)];
    if (transmits(material))
      throw SceneError(child.place, title(node) + " holds a material that transmits light, expected an opaque one");
    // A twosided within a twosided is only ever seen from its front.
    if (const auto* inner = std::get_if<TwosidedDescription>(&material)) side = inner->front;
    sides.push_back(side);
  }
  if (sides.empty() || sides.size() > 2) {
    throw SceneError(node.place, title(node) + " holds " + std::to_string(sides.size()) + " bsdfs, expected one or two");
  }
  return TwosidedDescription{sides.front(), sides.back()};
}

}  // namespace fluxfarm
