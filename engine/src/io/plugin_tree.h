// The scene as a tree of plugins with named parameters: what Mitsuba's XML and JSON forms have in common.
//
// The two syntaxes are read into this tree; the readers of the plugin families (read_shape.h ...) turn it into a
// SceneDescription and never see which syntax it came from.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "math/rgb.h"
#include "math/transform.h"

namespace fluxfarm {

enum class PluginKind {
  kScene,
  kIntegrator,
  kSensor,
  kSampler,
  kFilm,
  kFilter,
  kBsdf,
  kTexture,
  kShape,
  kEmitter,
  kMedium,
  kPhase,
  kReference,
  kUnsupported
};

using Triple = std::array<double, 3>;  // a point or a vector

// The same value at every wavelength; as a reflectance it is a grey, as a light it has the colour of equal-energy white.
struct UniformSpectrum {
  double value = 0;
};

using PropertyValue = std::variant<bool, std::int64_t, double, std::string, Rgb, UniformSpectrum, Triple, Transform>;

struct Property {
  std::string name;
  PropertyValue value;
  std::string place;  // "scene.xml:12" or "scene.json: camera.fov"
};

struct PluginNode {
  PluginKind kind = PluginKind::kScene;
  std::string type;  // "diffuse"
  std::string id;    // may be empty; of a reference: the id that it refers to
  std::string name;  // role in the parent; may be empty
  std::string place;
  std::vector<Property> properties;
  std::vector<PluginNode> children;  // plugins and references in the order of the file
};

// The XML tag of a kind: "rfilter" for kFilter.
std::string_view tag_of(PluginKind kind);

// The kind for an XML tag; kUnsupported for plugin tags of Mitsuba that we do not read; nothing if it is no plugin tag.
std::optional<PluginKind> kind_of_tag(std::string_view tag);

// The kind of a plugin type, as JSON needs it; nothing if the type is unknown.
std::optional<PluginKind> kind_of_type(std::string_view type);

// Throws SceneError at `place` unless `type` is a known plugin of that tag.
void check_plugin_known(std::string_view tag, PluginKind kind, const std::string& type, const std::string& place);

// `bsdf "diffuse"`, as messages name a plugin.
std::string title(const PluginNode& node);

}  // namespace fluxfarm
