// The parameters of one plugin, read by name. Remembers which names were asked for, so that every unknown parameter is an
// error.
#pragma once

#include <limits>
#include <set>
#include <string>

#include "io/plugin_tree.h"

namespace fluxfarm {

// Numbers from min to max; the bounds belong to it unless `open`.
struct NumberRange {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool open = false;
};

inline constexpr NumberRange kAnyNumber{};
inline constexpr NumberRange kUnitInterval{0, 1};
inline constexpr NumberRange kNotNegative{0};
inline constexpr NumberRange kPositive{0, std::numeric_limits<double>::infinity(), true};

class Properties {
 public:
  // `node` must outlive this object. Throws SceneError if a parameter is given twice.
  explicit Properties(const PluginNode& node);

  bool has(const std::string& name);

  // Each returns `otherwise` if the parameter is absent and throws SceneError if it has the wrong type or lies outside `range`.
  bool boolean(const std::string& name, bool otherwise);
  std::int64_t integer(const std::string& name, std::int64_t otherwise, NumberRange range = kAnyNumber);
  float number(const std::string& name, float otherwise, NumberRange range = kAnyNumber);
  std::string text(const std::string& name, const std::string& otherwise);
  Triple triple(const std::string& name, const Triple& otherwise);
  Transform transform(const std::string& name);  // identity if absent

  // A reflectance, transmittance or index of refraction: rgb, or a number as a grey.
  Rgb rgb(const std::string& name, Rgb otherwise, NumberRange range);
  // Emitted light, not negative: as rgb(), but a uniform spectrum has the colour of equal-energy white, as in Mitsuba.
  Rgb emission(const std::string& name, Rgb otherwise);
  // A text, or a number: for indices of refraction, which may be given by name. Nothing if absent.
  const PropertyValue* raw(const std::string& name);

  // The texture, or the reference to one, that stands inside the plugin under that name; null if there is none. Throws SceneError
  // if there are two, or a plain value as well.
  const PluginNode* texture(const std::string& name);

  // Parameters that are accepted and have no effect here; README.md lists them.
  void ignore(std::initializer_list<const char*> names);

  // Throws SceneError for the first parameter that nobody asked for. Call it after the last read.
  void finish() const;
  // The same for what stands inside the plugin, if textures are all that it takes.
  void finish_textures() const;

  // Throws SceneError at the place of the parameter (of the plugin if it is absent).
  [[noreturn]] void fail(const std::string& name, const std::string& what) const;

 private:
  const Property* find(const std::string& name);
  template <typename Value>
  const Value& expect(const Property& property, const char* expected) const;

  const PluginNode& node_;
  std::set<std::string> asked_, asked_textures_;
};

// The children of a plugin that may not have any; throws SceneError for the first. `takes` says what the plugin does take.
[[noreturn]] void fail_nested(const PluginNode& parent, const PluginNode& child, const std::string& takes);
void check_no_children(const PluginNode& node);

}  // namespace fluxfarm
