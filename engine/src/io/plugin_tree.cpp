#include "io/plugin_tree.h"

#include <algorithm>

#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

struct Tag {
  std::string_view tag;
  PluginKind kind;
};

constexpr Tag kTags[] = {
    {"scene", PluginKind::kScene},
    {"integrator", PluginKind::kIntegrator},
    {"sensor", PluginKind::kSensor},
    {"sampler", PluginKind::kSampler},
    {"film", PluginKind::kFilm},
    {"rfilter", PluginKind::kFilter},
    {"bsdf", PluginKind::kBsdf},
    {"texture", PluginKind::kTexture},
    {"shape", PluginKind::kShape},
    {"emitter", PluginKind::kEmitter},
    {"medium", PluginKind::kMedium},
    {"phase", PluginKind::kPhase},
    {"ref", PluginKind::kReference},
    {"volume", PluginKind::kUnsupported},
    {"subsurface", PluginKind::kUnsupported},
};

struct KnownPlugin {
  std::string_view type;
  PluginKind kind;
};

constexpr KnownPlugin kKnownPlugins[] = {
    {"scene", PluginKind::kScene},
    {"path", PluginKind::kIntegrator},
    {"photon", PluginKind::kIntegrator},
    {"photon-progressive", PluginKind::kIntegrator},
    {"irradiance-cache", PluginKind::kIntegrator},
    {"perspective", PluginKind::kSensor},
    {"independent", PluginKind::kSampler},
    {"stratified", PluginKind::kSampler},
    {"multijitter", PluginKind::kSampler},
    {"orthogonal", PluginKind::kSampler},
    {"ldsampler", PluginKind::kSampler},
    {"halton", PluginKind::kSampler},
    {"sobol", PluginKind::kSampler},
    {"hdrfilm", PluginKind::kFilm},
    {"box", PluginKind::kFilter},
    {"tent", PluginKind::kFilter},
    {"gaussian", PluginKind::kFilter},
    {"diffuse", PluginKind::kBsdf},
    {"twosided", PluginKind::kBsdf},
    {"dielectric", PluginKind::kBsdf},
    {"roughdielectric", PluginKind::kBsdf},
    {"conductor", PluginKind::kBsdf},
    {"roughconductor", PluginKind::kBsdf},
    {"plastic", PluginKind::kBsdf},
    {"roughplastic", PluginKind::kBsdf},
    {"principled", PluginKind::kBsdf},
    {"thindielectric", PluginKind::kBsdf},
    {"null", PluginKind::kBsdf},
    {"mask", PluginKind::kBsdf},
    {"blendbsdf", PluginKind::kBsdf},
    {"normalmap", PluginKind::kBsdf},
    {"bumpmap", PluginKind::kBsdf},
    {"obj", PluginKind::kShape},
    {"ply", PluginKind::kShape},
    {"rectangle", PluginKind::kShape},
    {"cube", PluginKind::kShape},
    {"sphere", PluginKind::kShape},
    {"disk", PluginKind::kShape},
    {"gltf", PluginKind::kShape},
    {"area", PluginKind::kEmitter},
    {"point", PluginKind::kEmitter},
    {"spot", PluginKind::kEmitter},
    {"directional", PluginKind::kEmitter},
    {"constant", PluginKind::kEmitter},
    {"envmap", PluginKind::kEmitter},
    {"thinlens", PluginKind::kSensor},
    {"bitmap", PluginKind::kTexture},
    {"checkerboard", PluginKind::kTexture},
    {"mesh_attribute", PluginKind::kTexture},
    {"volpath", PluginKind::kIntegrator},
    {"volpathmis", PluginKind::kIntegrator},
    {"homogeneous", PluginKind::kMedium},
    {"isotropic", PluginKind::kPhase},
    {"hg", PluginKind::kPhase},
};

std::string known_types(PluginKind kind) {
  std::vector<std::string> types;
  for (const KnownPlugin& plugin : kKnownPlugins) {
    if (plugin.kind == kind) types.emplace_back(plugin.type);
  }
  return joined(types);
}

}  // namespace

std::string_view tag_of(PluginKind kind) {
  return std::find_if(std::begin(kTags), std::end(kTags), [&](const Tag& tag) { return tag.kind == kind; })->tag;
}

std::optional<PluginKind> kind_of_tag(std::string_view tag) {
  for (const Tag& known : kTags) {
    if (known.tag == tag) return known.kind;
  }
  return std::nullopt;
}

std::optional<PluginKind> kind_of_type(std::string_view type) {
  for (const KnownPlugin& plugin : kKnownPlugins) {
    if (plugin.type == type) return plugin.kind;
  }
  return std::nullopt;
}

void check_plugin_known(std::string_view tag, PluginKind kind, const std::string& type, const std::string& place) {
  if (kind_of_type(type) == kind) return;
  const std::string what = "unknown plugin: " + std::string(tag) + " " + in_quotes(type);
  if (kind == PluginKind::kUnsupported) throw SceneError(place, what + "; no " + std::string(tag) + " is supported yet");
  throw SceneError(place, what + ", expected one of: " + known_types(kind));
}

std::string title(const PluginNode& node) {
  if (node.kind == PluginKind::kReference) return "reference to " + in_quotes(node.id);
  return std::string(tag_of(node.kind)) + " " + in_quotes(node.type);
}

}  // namespace fluxfarm
