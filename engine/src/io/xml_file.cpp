#include "io/xml_file.h"

#include <algorithm>
#include <cstring>

#include "io/bundle.h"
#include "io/limits.h"
#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {

XmlFile::XmlFile(const std::filesystem::path& file, const std::string& name) : name_(name) {
  const std::string text = read_file(file, name, kMaxSceneTextBytes);
  if (!is_utf8(text)) throw SceneError(name, "is not UTF-8 text");
  line_starts_.push_back(0);
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\n') line_starts_.push_back(static_cast<std::ptrdiff_t>(i + 1));
  }
  constexpr unsigned kFlags = pugi::parse_default | pugi::parse_doctype | pugi::parse_trim_pcdata;
  const pugi::xml_parse_result result = document_.load_buffer(text.data(), text.size(), kFlags, pugi::encoding_utf8);
  if (!result) {
    throw SceneError(place_of_offset(result.offset), std::string("is not well-formed XML: ") + result.description());
  }
  check_nodes();
}

void XmlFile::check_nodes() const {
  // Iterative: pugixml's traversal and its destruction of a document do not recurse, so any depth can be reported.
  struct Checker : pugi::xml_tree_walker {
    explicit Checker(const XmlFile& xml_file) : file(xml_file) {}
    bool for_each(pugi::xml_node& node) override {
      if (node.type() == pugi::node_doctype) {
        throw SceneError(file.place(node), "a DOCTYPE is not allowed: scenes define no entities, use <default> instead");
      }
      if (depth() >= kMaxNesting) {
        throw SceneError(file.place(node), "elements are nested deeper than " + std::to_string(kMaxNesting) + " levels");
      }
      if (std::strlen(node.name()) > kMaxNameLength) throw SceneError(file.place(node), "the name of an element is too long");
      if (node.type() == pugi::node_pcdata || node.type() == pugi::node_cdata) {
        throw SceneError(file.place(node), "text " + in_quotes(node.value()) + " between the elements, expected only elements");
      }
      return true;
    }
    const XmlFile& file;
  };
  Checker checker(*this);
  pugi::xml_node document = document_;
  document.traverse(checker);
}

std::string XmlFile::place_of_offset(std::ptrdiff_t offset) const {
  const auto next_line = std::upper_bound(line_starts_.begin(), line_starts_.end(), offset);
  return name_ + ":" + std::to_string(next_line - line_starts_.begin());
}

}  // namespace fluxfarm
