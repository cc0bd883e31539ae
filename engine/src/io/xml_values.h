// The value elements of Mitsuba's XML: boolean, integer, float, string, rgb, spectrum, point, vector, transform.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "io/plugin_tree.h"
#include "io/xml_file.h"

namespace fluxfarm {

// The attributes of one element, after $name substitution, by name.
class XmlAttributes {
 public:
  using Substitute = std::function<std::string(const std::string& text, const std::string& place)>;

  XmlAttributes(const pugi::xml_node& element, const std::string& place, const Substitute& substitute);

  bool has(const std::string& name) const { return values_.count(name) != 0; }
  // Throws SceneError if the attribute is missing.
  const std::string& text(const std::string& name) const;
  std::string text_or(const std::string& name, const std::string& otherwise) const;
  double number(const std::string& name) const;
  // Exactly three numbers in one attribute.
  Triple triple(const std::string& name) const;
  // Throws SceneError if there is an attribute that is not in `allowed`.
  void check_names(const std::vector<std::string>& allowed) const;

  [[noreturn]] void fail(const std::string& what) const;
  const std::string& place() const { return place_; }

 private:
  std::string tag_, place_;
  std::map<std::string, std::string> values_;
};

// The value of a property element, or nothing if the tag is no value tag.
std::optional<PropertyValue> read_xml_value(const XmlFile& file, const pugi::xml_node& element,
                                            const XmlAttributes::Substitute& substitute);

}  // namespace fluxfarm
