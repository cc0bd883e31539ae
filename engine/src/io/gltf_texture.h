// Textures of a glTF file: images beside it, in its buffers or in data URIs, decoded by read_image when a material shows them.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "io/gltf_file.h"
#include "textures/texture_description.h"

namespace fluxfarm {

// What of an image a texture shows: sRGB colours, three numbers, or its alpha channel as a grey.
enum class GltfChannels { kColors, kNumbers, kAlpha };

class GltfTextures {
 public:
  // Appends to `textures` and `warnings`. Everything must outlive this.
  GltfTextures(GltfFile& file, std::vector<TextureDescription>& textures, std::vector<std::string>& warnings)
      : file_(file), textures_(textures), warnings_(warnings) {}

  struct Use {
    int texture;     // index into the scene's textures
    int uv_set = 0;  // TEXCOORD_n of the mesh
  };
  // What the member `name` of a material shows; nothing if it is absent, its image has no alpha channel that is asked for, or its
  // texture no image that is read, which is a warning. Throws SceneError.
  std::optional<Use> read(const GltfObject& object, const char* name, GltfChannels channels);

  // Mean of the image of a texture that read() gave.
  Rgb mean(int texture) const;

 private:
  std::shared_ptr<const TextureImage> image(std::size_t index, GltfChannels channels);
  // Colours and alpha come from one decoding, and both are kept.
  void decode(std::size_t index, GltfChannels channels);
  void decode(std::size_t index, GltfChannels channels, const std::filesystem::path& file, const std::string& name);
  void warn_once(const std::string& warning);
  void read_sampler(const GltfObject& texture, BitmapDescription& bitmap);

  GltfFile& file_;
  std::vector<TextureDescription>& textures_;
  std::vector<std::string>& warnings_;
  std::map<std::pair<std::size_t, GltfChannels>, std::shared_ptr<const TextureImage>> images_;  // null: has no alpha channel
  std::set<std::string> warned_;  // a texture may be read twice, for colour and alpha
  std::size_t pixels_ = 0;
};

}  // namespace fluxfarm
