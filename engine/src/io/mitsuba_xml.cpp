#include "io/mitsuba_xml.h"

#include <algorithm>
#include <cctype>
#include <set>

#include "io/limits.h"
#include "io/text.h"
#include "io/xml_file.h"
#include "io/xml_values.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

bool is_name_character(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

// camelCase, as files before version 2 write parameters, to the underscores of Mitsuba 3: intIOR -> int_ior, toWorld ->
// to_world.
std::string with_underscores(const std::string& camel) {
  std::string result;
  for (std::size_t i = 0; i < camel.size(); ++i) {
    const bool upper = std::isupper(static_cast<unsigned char>(camel[i]));
    if (upper && i > 0 && std::islower(static_cast<unsigned char>(camel[i - 1]))) result += '_';
    result += static_cast<char>(upper ? std::tolower(static_cast<unsigned char>(camel[i])) : camel[i]);
  }
  return result;
}

class XmlSceneReader {
 public:
  XmlSceneReader(const Bundle& bundle, const SceneOverrides& overrides) : bundle_(bundle), variables_(overrides) {
    for (const auto& [name, value] : overrides) unused_overrides_.insert(name);
  }

  PluginNode read() {
    PluginNode scene;
    read_file_into(bundle_.entry(), scene, false, nullptr);
    if (!unused_overrides_.empty()) {
      throw SceneError(bundle_.name(bundle_.entry()), "the scene does not use $" + *unused_overrides_.begin() +
                                                          ", which was given from outside; it has " + known_variables());
    }
    return scene;
  }

 private:
  // The document that an element comes from.
  struct Source {
    const XmlFile& file;
    bool legacy;  // written for a Mitsuba before 2, with camelCase names
  };

  // Reads the entry file (`include` is null: `target` becomes the scene) or the content of an included one into `target`.
  void read_file_into(const std::filesystem::path& path, PluginNode& target, bool legacy_parent, const std::string* include) {
    const XmlFile file(path, bundle_.name(path));
    const pugi::xml_node root = file.root();
    if (!root) throw SceneError(bundle_.name(path), "has no element, expected <scene>");
    const Source source{file, is_legacy(file, root, legacy_parent)};
    open_files_.push_back(path);
    if (std::string(root.name()) == "scene") {
      const XmlAttributes attributes(root, file.place(root), substitute());
      attributes.check_names({"version", "id", "type"});
      if (!include) {
        target.kind = PluginKind::kScene;
        target.type = "scene";
        target.place = file.place(root);
      }
      read_children(source, root, target);
    } else if (include) {
      read_element(source, root, target);
    } else {
      throw SceneError(file.place(root), std::string("the outermost element is <") + root.name() + ">, expected <scene>");
    }
    open_files_.pop_back();
  }

  bool is_legacy(const XmlFile& file, const pugi::xml_node& root, bool otherwise) const {
    const pugi::xml_attribute version = root.attribute("version");
    if (!version) return otherwise;
    const std::string text = version.value();
    const std::optional<std::int64_t> major = parse_integer(text.substr(0, text.find('.')));
    if (!major || *major < 0)
      throw SceneError(file.place(root), "version = " + in_quotes(text) + ", expected three numbers as in 3.0.0");
    return *major < 2;
  }

  void read_children(const Source& source, const pugi::xml_node& element, PluginNode& node) {
    for (const pugi::xml_node& child : element.children()) {
      if (child.type() == pugi::node_element) read_element(source, child, node);
    }
  }

  void read_element(const Source& source, const pugi::xml_node& element, PluginNode& parent) {
    const std::string tag = element.name();
    const std::string place = source.file.place(element);
    if (tag == "default") return read_default(element, place);
    if (tag == "include") return read_include(source, element, place, parent);
    if (const auto value = read_xml_value(source.file, element, substitute())) {
      const std::string name = XmlAttributes(element, place, substitute()).text("name");
      parent.properties.push_back({property_name(source, parent, name), *value, place});
      return;
    }
    const std::optional<PluginKind> kind = kind_of_tag(tag);
    if (!kind || *kind == PluginKind::kScene) throw SceneError(place, "unknown element <" + tag + "> in " + title(parent));
    parent.children.push_back(read_plugin(source, element, tag, *kind));
    PluginNode& child = parent.children.back();
    child.name = property_name(source, parent, child.name);
  }

  PluginNode read_plugin(const Source& source, const pugi::xml_node& element, const std::string& tag, PluginKind kind) {
    PluginNode node;
    node.kind = kind;
    node.place = source.file.place(element);
    const XmlAttributes attributes(element, node.place, substitute());
    node.name = attributes.text_or("name", "");
    if (kind == PluginKind::kReference) {
      attributes.check_names({"id", "name"});
      node.id = attributes.text("id");
      if (element.first_child()) attributes.fail("has elements inside, expected none");
      return node;
    }
    attributes.check_names({"type", "id", "name", "version"});
    node.type = attributes.text("type");
    node.id = attributes.text_or("id", "");
    check_plugin_known(tag, kind, node.type, node.place);
    read_children(source, element, node);
    return node;
  }

  std::string property_name(const Source& source, const PluginNode& parent, const std::string& name) const {
    if (!source.legacy) return name;
    std::string modern = with_underscores(name);
    if (parent.type == "diffuse" && modern == "diffuse_reflectance") return "reflectance";
    return modern;
  }

  void read_default(const pugi::xml_node& element, const std::string& place) {
    const XmlAttributes attributes(element, place, substitute());
    attributes.check_names({"name", "value"});
    const std::string& name = attributes.text("name");
    if (name.empty() || !std::all_of(name.begin(), name.end(), is_name_character)) {
      attributes.fail("name = " + in_quotes(name) + ", expected letters, digits and _");
    }
    unused_overrides_.erase(name);
    variables_.emplace(name, attributes.text("value"));  // the first one wins, and overrides were there before
  }

  void read_include(const Source& source, const pugi::xml_node& element, const std::string& place, PluginNode& parent) {
    const XmlAttributes attributes(element, place, substitute());
    attributes.check_names({"filename"});
    const std::string& filename = attributes.text("filename");
    const std::filesystem::path path = bundle_.find(filename, place);
    if (std::find(open_files_.begin(), open_files_.end(), path) != open_files_.end()) {
      attributes.fail("filename = " + in_quotes(filename) + " includes itself, directly or through other files");
    }
    if (open_files_.size() > kMaxIncludeDepth) {
      attributes.fail("filename = " + in_quotes(filename) + " is included through more than " + std::to_string(kMaxIncludeDepth) +
                      " files");
    }
    if (++includes_ > kMaxIncludes)
      attributes.fail("is one of more than " + std::to_string(kMaxIncludes) + " includes of this scene");
    read_file_into(path, parent, source.legacy, &place);
  }

  XmlAttributes::Substitute substitute() {
    return [this](const std::string& text, const std::string& place) { return substituted(text, place); };
  }

  // The text with every $name replaced. A $ that no name follows stays.
  std::string substituted(const std::string& text, const std::string& place) {
    if (text.size() > kMaxAttributeLength)
      throw SceneError(place, "an attribute is longer than " + std::to_string(kMaxAttributeLength) + " bytes");
    std::string result;
    for (std::size_t i = 0; i < text.size();) {
      if (text[i] != '$' || i + 1 == text.size() || !is_name_character(text[i + 1])) {
        result += text[i++];
        continue;
      }
      const auto end = std::find_if_not(text.begin() + static_cast<std::ptrdiff_t>(i) + 1, text.end(), is_name_character);
      const std::string name(text.begin() + static_cast<std::ptrdiff_t>(i) + 1, end);
      const auto found = variables_.find(name);
      if (found == variables_.end()) {
        throw SceneError(place, "$" + name + " has no value; put <default name=\"" + name +
                                    "\" value=\"...\"/> before it or give it from outside");
      }
      unused_overrides_.erase(name);
      result += found->second;
      if (result.size() > kMaxAttributeLength) throw SceneError(place, "an attribute grows too long by $" + name);
      i += name.size() + 1;
    }
    return result;
  }

  std::string known_variables() const {
    std::vector<std::string> names;
    for (const auto& [name, value] : variables_) {
      if (!unused_overrides_.count(name)) names.push_back("$" + name);
    }
    return names.empty() ? "none" : joined(names);
  }

  const Bundle& bundle_;
  std::map<std::string, std::string> variables_;
  std::set<std::string> unused_overrides_;
  std::vector<std::filesystem::path> open_files_;
  int includes_ = 0;
};

}  // namespace

PluginNode read_mitsuba_xml(const Bundle& bundle, const SceneOverrides& overrides) {
  return XmlSceneReader(bundle, overrides).read();
}

}  // namespace fluxfarm
