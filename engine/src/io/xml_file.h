// One XML file, parsed and checked for the dangers of XML: document types, depth, size. Knows the line of every element.
#pragma once

#include <filesystem>
#include <pugixml.hpp>
#include <string>
#include <vector>

namespace fluxfarm {

class XmlFile {
 public:
  // Throws SceneError for text that is not UTF-8 or not well-formed, for any DOCTYPE (so no entity can be defined), for nesting
  // deeper than kMaxNesting and for text between elements. `name` is the file as messages show it.
  XmlFile(const std::filesystem::path& file, const std::string& name);

  pugi::xml_node root() const { return document_.document_element(); }

  // "scene.xml:12" for an element of this file.
  std::string place(const pugi::xml_node& node) const { return place_of_offset(node.offset_debug()); }

 private:
  std::string place_of_offset(std::ptrdiff_t offset) const;
  void check_nodes() const;

  std::string name_;
  std::vector<std::ptrdiff_t> line_starts_;
  pugi::xml_document document_;
};

}  // namespace fluxfarm
