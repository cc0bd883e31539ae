// Materials of a glTF file: what a primitive scatters and emits.
#pragma once

#include <map>
#include <optional>

#include "io/gltf_texture.h"
#include "scene/description.h"

namespace fluxfarm {

struct GltfMaterial {
  int index = 0;                        // into the scene's materials
  std::optional<Rgb> emitted_radiance;  // W m^-2 sr^-1; a light
  bool double_sided = false;
  int uv_set = 0;                   // TEXCOORD_n that its textures ask for
  int interior_medium = kNoMedium;  // of the volume that it bounds, on its back side: index into the scene's media
  bool has_alpha = false;           // alphaMode is MASK or BLEND
};

class GltfMaterials {
 public:
  // Appends to the materials, media and warnings of `scene`, and through `textures`. Everything must outlive this.
  GltfMaterials(GltfFile& file, GltfTextures& textures, SceneDescription& scene)
      : file_(file), textures_(textures), scene_(scene) {}

  // The material of a primitive, or the default of glTF; one that shows the colours of its vertices if it has COLOR_0. Each is read
  // once. Throws SceneError.
  GltfMaterial of_primitive(const GltfObject& primitive);

 private:
  class Reader;

  // A material and what to make of it for the primitives with and without colours of vertices, each when first asked for.
  struct Known {
    GltfMaterial material;
    GltfDescription surface;
    std::optional<NormalMapDescription> normal_map;  // around the surface
    std::optional<MaskDescription> mask;             // around both
    std::optional<int> plain, colored;               // indices into the scene's materials
  };

  int add(Known known, bool vertex_colors);
  int add(const MaterialDescription& material);

  GltfFile& file_;
  GltfTextures& textures_;
  SceneDescription& scene_;
  std::map<std::optional<std::size_t>, Known> known_;
};

}  // namespace fluxfarm
