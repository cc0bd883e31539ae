#include "io/mitsuba_json.h"

#include "io/json_value.h"
#include "io/json_values.h"
#include "io/limits.h"
#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

const std::string& type_of(const JsonValue& json, const std::string& place) {
  const JsonValue* type = json.member("type");
  if (!type) throw SceneError(place, "lacks the member \"type\", which names the plugin");
  if (!type->text()) throw SceneError(place + ".type", "is " + described(*type) + ", expected the name of a plugin");
  return *type->text();
}

std::string id_of(const JsonValue& json, const std::string& place) {
  const JsonValue* id = json.member("id");
  if (!id) return "";
  if (!id->text()) throw SceneError(place + ".id", "is " + described(*id) + ", expected a text");
  return *id->text();
}

bool is_plugin(const JsonValue& json) {
  const JsonValue* type = json.member("type");
  return json.object() && !(type && type->text() && (*type->text() == "rgb" || *type->text() == "spectrum"));
}

PluginNode read_reference(const JsonValue& json, const std::string& place) {
  PluginNode node;
  node.kind = PluginKind::kReference;
  node.place = place;
  node.id = id_of(json, place);
  if (node.id.empty()) throw SceneError(place, "lacks the member \"id\", which names what is referred to");
  if (json.object()->size() > 2) throw SceneError(place, "a reference takes only \"type\" and \"id\"");
  return node;
}

PluginNode read_plugin(const JsonValue& json, const std::string& place);

// Recursion is bounded by kMaxNesting, which parse_json has checked.
void read_members(const JsonValue& json, const std::string& prefix, PluginNode& node) {
  for (const JsonMember& member : *json.object()) {
    if (member.name == "type" || member.name == "id") continue;
    const std::string place = prefix + member.name;
    if (is_plugin(member.value)) {
      node.children.push_back(read_plugin(member.value, place));
      node.children.back().name = member.name;
    } else {
      node.properties.push_back({member.name, read_json_value(member.value, place), place});
    }
  }
}

PluginNode read_plugin(const JsonValue& json, const std::string& place) {
  const std::string& type = type_of(json, place);
  if (type == "ref") return read_reference(json, place);
  const std::optional<PluginKind> kind = kind_of_type(type);
  if (!kind || *kind == PluginKind::kScene)
    throw SceneError(place, "unknown plugin " + in_quotes(type) + "; engine/src/io/README.md lists the known ones");
  PluginNode node;
  node.kind = *kind;
  node.type = type;
  node.id = id_of(json, place);
  node.place = place;
  read_members(json, place + ".", node);
  return node;
}

}  // namespace

PluginNode read_mitsuba_json(const Bundle& bundle) {
  const std::string name = bundle.name(bundle.entry());
  const JsonValue json = parse_json(read_file(bundle.entry(), name, kMaxSceneTextBytes), name);
  if (!json.object()) throw SceneError(name, "is " + described(json) + ", expected an object with \"type\": \"scene\"");
  if (type_of(json, name) != "scene")
    throw SceneError(name, "the outermost type is " + in_quotes(type_of(json, name)) + ", expected \"scene\"");
  PluginNode scene;
  scene.type = "scene";
  scene.place = name;
  read_members(json, name + ": ", scene);
  // What the scene holds directly can be referred to by its member name.
  for (PluginNode& child : scene.children) {
    if (child.kind != PluginKind::kReference && child.id.empty()) child.id = child.name;
  }
  return scene;
}

}  // namespace fluxfarm
