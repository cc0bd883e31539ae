// Materials that hold others: twosided, mask, blendbsdf, bumpmap, normalmap.
#include <string>

#include "io/material_parameters.h"
#include "io/properties.h"
#include "io/read_material.h"
#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

// Whether a child is a texture, or refers to one.
bool is_texture(const PluginNode& child, const PluginsById& plugins) {
  if (child.kind != PluginKind::kReference) return child.kind == PluginKind::kTexture;
  const auto found = plugins.find(child.id);
  return found != plugins.end() && found->second->kind == PluginKind::kTexture;
}

}  // namespace

std::vector<int> MaterialReader::read_held(const PluginNode& node, std::size_t least, std::size_t most,
                                           const std::string& texture) {
  std::string takes = least == 1 && most == 2 ? "one or two bsdfs" : most == 1 ? "one bsdf" : "two bsdfs";
  const std::string bsdfs = takes;
  if (!texture.empty()) takes += " and a texture named " + texture;
  std::vector<int> held;
  for (const PluginNode& child : node.children) {
    if (!texture.empty() && child.name == texture && is_texture(child, plugins_)) continue;
    if (child.kind != PluginKind::kBsdf && child.kind != PluginKind::kReference) fail_nested(node, child, takes);
    held.push_back(read(child));
  }
  if (held.size() < least || held.size() > most) {
    throw SceneError(node.place, title(node) + " holds " + std::to_string(held.size()) + " bsdfs, expected " +
                                     bsdfs.substr(0, bsdfs.find(" bsdf")));
  }
  return held;
}

TwosidedDescription MaterialReader::read_twosided(const PluginNode& node) {
  Properties(node).finish();
  std::vector<int> sides = read_held(node, 1, 2, "");
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (transmits(sides[i])) {
      throw SceneError(node.children[i].place, title(node) + " holds a material that transmits light, expected an opaque one");
    }
    // A twosided within a twosided is only ever seen from its front.
    const auto* inner = std::get_if<TwosidedDescription>(&materials_[static_cast<std::size_t>(sides[i])]);
    if (inner != nullptr) sides[i] = inner->front;
  }
  return {sides.front(), sides.back()};
}

MaskDescription MaterialReader::read_mask(const PluginNode& node) {
  Properties properties(node);
  MaskDescription result;
  result.opacity = read_scalar(properties, textures_, "opacity", 0.5f);
  properties.finish();
  result.material = read_held(node, 1, 1, "opacity").front();
  return result;
}

BlendDescription MaterialReader::read_blend(const PluginNode& node) {
  Properties properties(node);
  if (!properties.has("weight") && properties.texture("weight") == nullptr)
    properties.fail("weight", "lacks the parameter \"weight\"");
  BlendDescription result;
  result.weight = read_scalar(properties, textures_, "weight", 0.5f);
  properties.finish();
  const std::vector<int> held = read_held(node, 2, 2, "weight");
  result.first = held[0];
  result.second = held[1];
  return result;
}

NormalMapDescription MaterialReader::read_normal_map(const PluginNode& node) {
  Properties properties(node);
  const PluginNode* normals = properties.texture("normalmap");
  properties.finish();
  if (normals == nullptr) throw SceneError(node.place, title(node) + " lacks a texture named \"normalmap\"");
  NormalMapDescription result;
  result.normals_texture = textures_.read(*normals);
  result.material = read_held(node, 1, 1, "normalmap").front();
  return result;
}

BumpMapDescription MaterialReader::read_bump_map(const PluginNode& node) {
  Properties properties(node);
  BumpMapDescription result;
  result.scale = properties.number("scale", 1);
  properties.finish();
  // The one texture, whatever its name; as in Mitsuba.
  const PluginNode* height = nullptr;
  std::vector<int> held;
  for (const PluginNode& child : node.children) {
    if (is_texture(child, plugins_)) {
      if (height != nullptr) fail_nested(node, child, "one texture and one bsdf");
      height = &child;
    } else if ((child.kind == PluginKind::kBsdf || child.kind == PluginKind::kReference) && held.empty()) {
      held.push_back(read(child));
    } else {
      fail_nested(node, child, "one texture and one bsdf");
    }
  }
  if (height == nullptr || held.empty()) {
    throw SceneError(node.place,
                     title(node) + " lacks a " + (height == nullptr ? "texture" : "bsdf") + ", expected one texture and one bsdf");
  }
  result.material = held.front();
  result.height_texture = textures_.read(*height);
  if (!textures_.is_smooth(result.height_texture)) {
    throw SceneError(height->place, title(node) + ": the texture has no slope, expected a bitmap with filter_type bilinear");
  }
  return result;
}

bool MaterialReader::transmits(int material) const {
  struct Visitor {
    const MaterialReader& reader;
    bool operator()(const DielectricDescription&) const { return true; }
    bool operator()(const RoughDielectricDescription&) const { return true; }
    bool operator()(const ThinDielectricDescription&) const { return true; }
    bool operator()(const NullDescription&) const { return true; }
    bool operator()(const MaskDescription&) const { return true; }
    bool operator()(const PrincipledDescription& d) const { return d.spec_trans.factor > 0; }
    bool operator()(const GltfDescription& d) const { return d.transmission > 0; }
    bool operator()(const BlendDescription& d) const { return reader.transmits(d.first) || reader.transmits(d.second); }
    bool operator()(const NormalMapDescription& d) const { return reader.transmits(d.material); }
    bool operator()(const BumpMapDescription& d) const { return reader.transmits(d.material); }
    bool operator()(const DiffuseDescription&) const { return false; }
    bool operator()(const ConductorDescription&) const { return false; }
    bool operator()(const RoughConductorDescription&) const { return false; }
    bool operator()(const PlasticDescription&) const { return false; }
    bool operator()(const RoughPlasticDescription&) const { return false; }
    bool operator()(const TwosidedDescription&) const { return false; }
  };
  return std::visit(Visitor{*this}, materials_[static_cast<std::size_t>(material)]);
}

}  // namespace fluxfarm
