// Reads bsdf plugins into material descriptions. A material that several shapes refer to is read once.
#pragma once

#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "io/plugin_references.h"
#include "io/plugin_tree.h"
#include "io/read_texture.h"
#include "materials/material_description.h"

namespace fluxfarm {

class MaterialReader {
 public:
  // Appends to `materials`, which must outlive the reader, as must the plugin tree and `textures`.
  MaterialReader(const PluginsById& plugins, TextureReader& textures, std::vector<MaterialDescription>& materials)
      : plugins_(plugins), textures_(textures), materials_(materials) {}

  // Index of the material of a bsdf, or of the bsdf that a reference means. Throws SceneError.
  int read(const PluginNode& bsdf_or_reference);

  // Index of a diffuse material of that grey reflectance, for shapes that name no bsdf.
  int diffuse(float reflectance);

  bool has_read(const PluginNode& bsdf) const { return indices_.count(&bsdf) != 0; }

 private:
  MaterialDescription read_twosided(const PluginNode& node);

  const PluginsById& plugins_;
  TextureReader& textures_;
  std::vector<MaterialDescription>& materials_;
  std::unordered_map<const PluginNode*, int> indices_;
  std::unordered_set<const PluginNode*> being_read_;
  std::unordered_map<float, int> greys_;
};

}  // namespace fluxfarm
