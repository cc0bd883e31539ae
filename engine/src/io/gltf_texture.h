// Textures of a glTF file: images beside it, in its buffers or in data URIs, decoded by read_image when a material shows them.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>

#include "io/gltf_file.h"
#include "textures/texture_description.h"

namespace fluxfarm {

class GltfTextures {
 public:
  // Appends to `textures` and `warnings`. Everything must outlive this.
  GltfTextures(GltfFile& file, std::vector<TextureDescription>& textures, std::vector<std::string>& warnings)
      : file_(file), textures_(textures), warnings_(warnings) {}

  struct Use {
    int texture;     // index into the scene's textures
    int uv_set = 0;  // TEXCOORD_n of the mesh
  };
  // What the member `name` of a material shows; nothing if it is absent, or its texture has no image that is read, which is a
  // warning. `raw`: numbers and no sRGB colours. Throws SceneError.
  std::optional<Use> read(const GltfObject& object, const char* name, bool raw);

  // Mean of the image of a texture that read() gave.
  Rgb mean(int texture) const;

 private:
  std::shared_ptr<const TextureImage> image(std::size_t index, bool raw);
  void read_sampler(const GltfObject& texture, BitmapDescription& bitmap);

  GltfFile& file_;
  std::vector<TextureDescription>& textures_;
  std::vector<std::string>& warnings_;
  std::map<std::pair<std::size_t, bool>, std::shared_ptr<const TextureImage>> images_;
  std::size_t pixels_ = 0;
};

}  // namespace fluxfarm
