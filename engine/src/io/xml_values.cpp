#include "io/xml_values.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "io/text.h"
#include "io/transform_steps.h"
#include "support/error.h"

namespace fluxfarm {

XmlAttributes::XmlAttributes(const pugi::xml_node& element, const std::string& place, const Substitute& substitute)
    : tag_(element.name()), place_(place) {
  for (const pugi::xml_attribute& attribute : element.attributes()) {
    if (!values_.emplace(attribute.name(), substitute(attribute.value(), place)).second) {
      fail("has the attribute " + in_quotes(attribute.name()) + " twice");
    }
  }
}

const std::string& XmlAttributes::text(const std::string& name) const {
  const auto found = values_.find(name);
  if (found == values_.end()) fail("lacks the attribute " + in_quotes(name));
  return found->second;
}

std::string XmlAttributes::text_or(const std::string& name, const std::string& otherwise) const {
  return has(name) ? text(name) : otherwise;
}

double XmlAttributes::number(const std::string& name) const {
  const std::optional<double> value = parse_number(text(name));
  if (!value || !std::isfinite(*value)) fail(name + " = " + in_quotes(text(name)) + ", expected a finite number");
  return *value;
}

Triple XmlAttributes::triple(const std::string& name) const {
  const auto values = parse_numbers(text(name));
  if (!values || values->size() != 3 || !std::all_of(values->begin(), values->end(), [](double v) { return std::isfinite(v); })) {
    fail(name + " = " + in_quotes(text(name)) + ", expected three finite numbers");
  }
  return {(*values)[0], (*values)[1], (*values)[2]};
}

void XmlAttributes::check_names(const std::vector<std::string>& allowed) const {
  for (const auto& [name, value] : values_) {
    if (std::find(allowed.begin(), allowed.end(), name) == allowed.end()) {
      fail("has no attribute " + in_quotes(name) + "; it takes " + joined(allowed));
    }
  }
}

void XmlAttributes::fail(const std::string& what) const { throw SceneError(place_, "<" + tag_ + "> " + what); }

namespace {

// `value` of one or three numbers as three; the rest of the message says what is expected.
Triple one_or_three(const XmlAttributes& attributes, const char* expected) {
  const std::string& text = attributes.text("value");
  const auto values = parse_numbers(text);
  const bool finite = values && std::all_of(values->begin(), values->end(), [](double v) { return std::isfinite(v); });
  if (!finite || (values->size() != 1 && values->size() != 3))
    attributes.fail("value = " + in_quotes(text) + ", expected " + expected);
  return values->size() == 1 ? Triple{(*values)[0], (*values)[0], (*values)[0]} : Triple{(*values)[0], (*values)[1], (*values)[2]};
}

// Either `value` or the attributes x, y and z; a missing one of these is `otherwise`, or an error if that is absent.
Triple read_xyz(const XmlAttributes& attributes, std::optional<double> otherwise) {
  if (attributes.has("value")) {
    if (attributes.has("x") || attributes.has("y") || attributes.has("z")) attributes.fail("has both value and x, y, z");
    return otherwise == 1.0 ? one_or_three(attributes, "one or three numbers") : attributes.triple("value");
  }
  const auto axis = [&](const char* name) { return !attributes.has(name) && otherwise ? *otherwise : attributes.number(name); };
  return {axis("x"), axis("y"), axis("z")};
}

Transform read_step(const std::string& tag, const XmlAttributes& attributes) {
  if (tag == "translate" || tag == "scale") {
    attributes.check_names({"x", "y", "z", "value"});
    const Triple v = read_xyz(attributes, tag == "scale" ? 1.0 : 0.0);
    return tag == "scale" ? Transform::scale(v[0], v[1], v[2]) : Transform::translate(v[0], v[1], v[2]);
  }
  if (tag == "rotate") {
    attributes.check_names({"x", "y", "z", "value", "angle"});
    return rotate_step(read_xyz(attributes, 0.0), attributes.number("angle"), attributes.place());
  }
  if (tag == "lookat" || tag == "lookAt") {
    attributes.check_names({"origin", "target", "up"});
    const Triple up = attributes.has("up") ? attributes.triple("up") : Triple{0, 1, 0};
    return look_at_step(attributes.triple("origin"), attributes.triple("target"), up, attributes.place());
  }
  if (tag == "matrix") {
    attributes.check_names({"value"});
    const auto values = parse_numbers(attributes.text("value"));
    if (!values) attributes.fail("value = " + in_quotes(attributes.text("value")) + ", expected 16 or 9 numbers");
    return matrix_step(*values, attributes.place());
  }
  attributes.fail("is no transform, expected translate, scale, rotate, lookat or matrix");
}

// Later steps are applied after earlier ones.
Transform read_transform(const XmlFile& file, const pugi::xml_node& element, const XmlAttributes& attributes,
                         const XmlAttributes::Substitute& substitute) {
  attributes.check_names({"name"});
  Transform result;
  for (const pugi::xml_node& step : element.children()) {
    if (step.type() != pugi::node_element) continue;
    if (step.first_child())
      throw SceneError(file.place(step), std::string("<") + step.name() + "> has elements inside, expected none");
    result = read_step(step.name(), XmlAttributes(step, file.place(step), substitute)) * result;
  }
  if (!result.is_finite()) attributes.fail("gives a matrix with infinite or NaN numbers");
  return result;
}

UniformSpectrum read_spectrum(const XmlAttributes& attributes) {
  attributes.check_names({"name", "value"});
  if (attributes.text("value").find(':') != std::string::npos) {
    attributes.fail("value = " + in_quotes(attributes.text("value")) +
                    ": spectra by wavelength are not supported, expected one number, or use <rgb>");
  }
  return {attributes.number("value")};
}

Rgb read_rgb(const XmlAttributes& attributes) {
  attributes.check_names({"name", "value"});
  const Triple v = one_or_three(attributes, "one or three numbers, as in 0.2, 0.5, 0.8");
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

}  // namespace

std::optional<PropertyValue> read_xml_value(const XmlFile& file, const pugi::xml_node& element,
                                            const XmlAttributes::Substitute& substitute) {
  const std::string tag = element.name();
  constexpr const char* kTags[] = {"boolean", "integer", "float", "string", "rgb", "spectrum", "point", "vector", "transform"};
  if (std::find(std::begin(kTags), std::end(kTags), tag) == std::end(kTags)) return std::nullopt;

  const XmlAttributes attributes(element, file.place(element), substitute);
  if (tag == "transform") return read_transform(file, element, attributes, substitute);
  if (element.first_child()) attributes.fail("has elements inside, expected none");
  if (tag == "rgb") return read_rgb(attributes);
  if (tag == "spectrum") return read_spectrum(attributes);
  if (tag == "point" || tag == "vector") {
    attributes.check_names({"name", "x", "y", "z", "value"});
    return read_xyz(attributes, std::nullopt);
  }
  attributes.check_names({"name", "value"});
  const std::string& text = attributes.text("value");
  if (tag == "string") return text;
  if (tag == "float") return attributes.number("value");
  if (tag == "integer") {
    const std::optional<std::int64_t> value = parse_integer(text);
    if (!value) attributes.fail("value = " + in_quotes(text) + ", expected an integer");
    return *value;
  }
  const std::optional<bool> value = parse_boolean(text);
  if (!value) attributes.fail("value = " + in_quotes(text) + ", expected true or false");
  return *value;
}

}  // namespace fluxfarm
