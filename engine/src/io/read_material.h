// Reads bsdf plugins into material descriptions. A material that several shapes refer to is read once.
#pragma once

#include <string>
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
  MaterialDescription read_any(const PluginNode& node);
  // Those that hold others: read_nested_material.cpp.
  TwosidedDescription read_twosided(const PluginNode& node);
  MaskDescription read_mask(const PluginNode& node);
  BlendDescription read_blend(const PluginNode& node);
  NormalMapDescription read_normal_map(const PluginNode& node);
  BumpMapDescription read_bump_map(const PluginNode& node);
  // Indices of the bsdfs inside a plugin, so many, beside a texture of that name; "" for none.
  std::vector<int> read_held(const PluginNode& node, std::size_t least, std::size_t most, const std::string& texture);
  bool transmits(int material) const;

  const PluginsById& plugins_;
  TextureReader& textures_;
  std::vector<MaterialDescription>& materials_;
  std::unordered_map<const PluginNode*, int> indices_;
  std::unordered_set<const PluginNode*> being_read_;
  std::unordered_map<float, int> greys_;
};

}  // namespace fluxfarm
