// Materials of a glTF file: what a primitive scatters and emits.
#pragma once

#include <map>
#include <optional>

#include "io/gltf_texture.h"
#include "materials/material_description.h"

namespace fluxfarm {

struct GltfMaterial {
  int index = 0;                        // into the scene's materials
  std::optional<Rgb> emitted_radiance;  // W m^-2 sr^-1; a light
  bool double_sided = false;
  int uv_set = 0;                       // TEXCOORD_n that its textures ask for
  std::optional<Rgb> absorption_per_m;  // of the volume that it bounds, on its back side
};

class GltfMaterials {
 public:
  // Appends to `materials`, through `textures`, and to `warnings`. Everything must outlive this.
  GltfMaterials(GltfFile& file, GltfTextures& textures, std::vector<MaterialDescription>& materials,
                std::vector<std::string>& warnings)
      : file_(file), textures_(textures), materials_(materials), warnings_(warnings) {}

  // The material of a primitive, or the default of glTF. Each is read once. Throws SceneError.
  const GltfMaterial& of_primitive(const GltfObject& primitive);

 private:
  class Reader;

  GltfFile& file_;
  GltfTextures& textures_;
  std::vector<MaterialDescription>& materials_;
  std::vector<std::string>& warnings_;
  std::map<std::optional<std::size_t>, GltfMaterial> known_;
};

}  // namespace fluxfarm
