#include "io/material_parameters.h"

#include "io/named_ior.h"
#include "io/text.h"

namespace fluxfarm {

Rgb read_colour(Properties& properties, TextureReader& textures, const std::string& name, Rgb otherwise, int& texture) {
  if (const PluginNode* node = properties.texture(name)) {
    texture = textures.read(*node);
    return Rgb(1);
  }
  return properties.rgb(name, otherwise, kUnitInterval);
}

ScalarParameter read_scalar(Properties& properties, TextureReader& textures, const std::string& name, float otherwise) {
  if (const PluginNode* node = properties.texture(name)) return {1, textures.read(*node)};
  return {properties.number(name, otherwise, kUnitInterval), kNoTexture};
}

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

}  // namespace fluxfarm
