#include "io/plugin_references.h"

#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

void collect(const PluginNode& node, PluginsById& plugins) {
  if (node.kind == PluginKind::kReference) return;
  if (!node.id.empty()) {
    const auto [found, is_new] = plugins.emplace(node.id, &node);
    if (!is_new) throw SceneError(node.place, "the id " + in_quotes(node.id) + " is already used at " + found->second->place);
  }
  for (const PluginNode& child : node.children) collect(child, plugins);
}

}  // namespace

PluginsById plugins_by_id(const PluginNode& scene) {
  PluginsById plugins;
  collect(scene, plugins);
  return plugins;
}

const PluginNode& referenced(const PluginNode& reference, PluginKind kind, const PluginsById& plugins) {
  const auto found = plugins.find(reference.id);
  if (found == plugins.end()) throw SceneError(reference.place, "nothing in the scene has the id " + in_quotes(reference.id));
  if (found->second->kind != kind) {
    throw SceneError(reference.place, "the id " + in_quotes(reference.id) + " belongs to a " + title(*found->second) + " at " +
                                          found->second->place + ", expected a " + std::string(tag_of(kind)));
  }
  return *found->second;
}

}  // namespace fluxfarm
