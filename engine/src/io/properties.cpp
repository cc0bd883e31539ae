#include "io/properties.h"

#include <cmath>

#include "io/emission_limits.h"
#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

// Linear Rec.709 of a spectrum of value 1 at all wavelengths, as Mitsuba 3.6 (scalar_rgb) integrates it.
constexpr Rgb kEqualEnergyWhite{1.204794f, 0.948292f, 0.908916f};

struct DescribeValue {
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(std::int64_t value) const { return std::to_string(value); }
  std::string operator()(double value) const { return number_text(value); }
  std::string operator()(const std::string& value) const { return in_quotes(value); }
  std::string operator()(Rgb v) const { return number_text(v.r) + ", " + number_text(v.g) + ", " + number_text(v.b); }
  std::string operator()(UniformSpectrum value) const { return number_text(value.value); }
  std::string operator()(const Triple& v) const { return number_text(v[0]) + ", " + number_text(v[1]) + ", " + number_text(v[2]); }
  std::string operator()(const Transform&) const { return "a transform"; }
};

std::string described(const PropertyValue& value) { return std::visit(DescribeValue{}, value); }

bool contains(NumberRange range, double value) {
  return range.open ? value > range.min && value < range.max : value >= range.min && value <= range.max;
}

std::string described(NumberRange range, const std::string& noun) {
  if (range.min == 0 && std::isinf(range.max)) return noun + (range.open ? " greater than 0" : " of at least 0");
  if (std::isinf(range.max)) return noun + (std::isinf(range.min) ? "" : " of at least " + number_text(range.min));
  const std::string bounds = number_text(range.min) + ", " + number_text(range.max);
  return noun + " in " + (range.open ? "(" + bounds + ")" : "[" + bounds + "]");
}

std::optional<double> as_number(const PropertyValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return static_cast<double>(*integer);
  return std::nullopt;
}

}  // namespace

Properties::Properties(const PluginNode& node) : node_(node) {
  std::set<std::string> seen;
  for (const Property& property : node.properties) {
    if (!seen.insert(property.name).second) {
      throw SceneError(property.place, title(node) + " has the parameter " + in_quotes(property.name) + " twice");
    }
  }
}

const Property* Properties::find(const std::string& name) {
  asked_.insert(name);
  for (const Property& property : node_.properties) {
    if (property.name == name) return &property;
  }
  return nullptr;
}

bool Properties::has(const std::string& name) { return find(name) != nullptr; }

void Properties::fail(const std::string& name, const std::string& what) const {
  for (const Property& property : node_.properties) {
    if (property.name == name) {
      throw SceneError(property.place, title(node_) + ": " + name + " = " + described(property.value) + ", " + what);
    }
  }
  throw SceneError(node_.place, title(node_) + ": " + what);
}

template <typename Value>
const Value& Properties::expect(const Property& property, const char* expected) const {
  if (const Value* value = std::get_if<Value>(&property.value)) return *value;
  fail(property.name, std::string("expected ") + expected);
}

bool Properties::boolean(const std::string& name, bool otherwise) {
  const Property* property = find(name);
  return property ? expect<bool>(*property, "true or false") : otherwise;
}

std::int64_t Properties::integer(const std::string& name, std::int64_t otherwise, NumberRange range) {
  const Property* property = find(name);
  if (!property) return otherwise;
  const std::string expected = described(range, "an integer");
  const std::int64_t value = expect<std::int64_t>(*property, expected.c_str());
  if (!contains(range, static_cast<double>(value))) fail(name, "expected " + expected);
  return value;
}

float Properties::number(const std::string& name, float otherwise, NumberRange range) {
  const Property* property = find(name);
  if (!property) return otherwise;
  const std::optional<double> value = as_number(property->value);
  if (!value || !contains(range, *value) || !std::isfinite(static_cast<float>(*value))) {
    fail(name, "expected " + described(range, "a number"));
  }
  return static_cast<float>(*value);
}

std::string Properties::text(const std::string& name, const std::string& otherwise) {
  const Property* property = find(name);
  return property ? expect<std::string>(*property, "a text") : otherwise;
}

Triple Properties::triple(const std::string& name, const Triple& otherwise) {
  const Property* property = find(name);
  return property ? expect<Triple>(*property, "a point or vector of three numbers") : otherwise;
}

Transform Properties::transform(const std::string& name) {
  const Property* property = find(name);
  return property ? expect<Transform>(*property, "a transform") : Transform();
}

Rgb Properties::rgb(const std::string& name, Rgb otherwise, NumberRange range) {
  const Property* property = find(name);
  if (!property) return otherwise;
  Rgb value;
  if (const auto number = as_number(property->value)) {
    value = Rgb(static_cast<float>(*number));
  } else if (const auto* spectrum = std::get_if<UniformSpectrum>(&property->value)) {
    value = Rgb(static_cast<float>(spectrum->value));
  } else {
    value = expect<Rgb>(*property, "a colour (rgb) or a number");
  }
  for (const float channel : {value.r, value.g, value.b}) {
    if (!std::isfinite(channel) || !contains(range, static_cast<double>(channel)))
      fail(name, "expected " + described(range, "numbers"));
  }
  return value;
}

Rgb Properties::emission(const std::string& name, Rgb otherwise) {
  const Property* property = find(name);
  const Rgb value = rgb(name, otherwise, kNotNegative);
  const bool is_spectrum = property && std::holds_alternative<UniformSpectrum>(property->value);
  const Rgb emitted = is_spectrum ? value * kEqualEnergyWhite : value;
  if (!is_within_emission_limits(emitted)) fail(name, kEmissionExpected);
  return emitted;
}

const PropertyValue* Properties::raw(const std::string& name) {
  const Property* property = find(name);
  return property ? &property->value : nullptr;
}

const PluginNode* Properties::texture(const std::string& name) {
  asked_textures_.insert(name);
  const PluginNode* found = nullptr;
  for (const PluginNode& child : node_.children) {
    if (child.name != name || (child.kind != PluginKind::kTexture && child.kind != PluginKind::kReference)) continue;
    if (found != nullptr || has(name)) {
      throw SceneError(child.place, title(node_) + " has the parameter " + in_quotes(name) + " twice");
    }
    found = &child;
  }
  return found;
}

void Properties::ignore(std::initializer_list<const char*> names) { asked_.insert(names.begin(), names.end()); }

void Properties::finish() const {
  for (const Property& property : node_.properties) {
    if (asked_.count(property.name)) continue;
    const std::vector<std::string> known(asked_.begin(), asked_.end());
    throw SceneError(property.place, title(node_) + " has no parameter " + in_quotes(property.name) +
                                         (known.empty() ? "; it takes none" : "; it takes " + joined(known)));
  }
}

void Properties::finish_textures() const {
  const std::vector<std::string> names(asked_textures_.begin(), asked_textures_.end());
  const std::string takes = names.empty() ? "no plugins" : "textures named " + joined(names);
  for (const PluginNode& child : node_.children) {
    const bool texture = child.kind == PluginKind::kTexture || child.kind == PluginKind::kReference;
    if (!texture || asked_textures_.count(child.name) == 0) {
      const std::string as = texture && !child.name.empty() ? " as " + in_quotes(child.name) : "";
      throw SceneError(child.place, title(node_) + " cannot hold a " + title(child) + as + "; it takes " + takes);
    }
  }
}

void fail_nested(const PluginNode& parent, const PluginNode& child, const std::string& takes) {
  throw SceneError(child.place, title(parent) + " cannot hold a " + title(child) + "; it takes " + takes);
}

void check_no_children(const PluginNode& node) {
  if (!node.children.empty()) fail_nested(node, node.children.front(), "no plugins");
}

}  // namespace fluxfarm
