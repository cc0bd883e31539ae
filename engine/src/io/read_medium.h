// Reads media and their phase functions into descriptions. A medium that several shapes refer to is read once.
#pragma once

#include <unordered_map>
#include <vector>

#include "io/plugin_references.h"
#include "io/plugin_tree.h"
#include "media/medium_description.h"

namespace fluxfarm {

class MediumReader {
 public:
  // Appends to `media`, which must outlive the reader, as must the plugin tree.
  MediumReader(const PluginsById& plugins, std::vector<HomogeneousMediumDescription>& media) : plugins_(plugins), media_(media) {}

  // Index of a medium, or of the medium that a reference means. Throws SceneError.
  int read(const PluginNode& medium_or_reference);

  bool has_read(const PluginNode& medium) const { return indices_.count(&medium) != 0; }

 private:
  HomogeneousMediumDescription read_homogeneous(const PluginNode& node);
  float read_asymmetry(const PluginNode& medium);

  const PluginsById& plugins_;
  std::vector<HomogeneousMediumDescription>& media_;
  std::unordered_map<const PluginNode*, int> indices_;
};

// Asymmetry of a phase function. Throws SceneError.
float read_phase(const PluginNode& phase);

// Whether a child of a shape is meant as the medium on one of its sides, by its name.
bool is_medium_of_shape(const PluginNode& child);

}  // namespace fluxfarm
