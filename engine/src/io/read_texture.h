// Reads texture plugins into texture descriptions. A texture that several materials refer to is read once, and so is an image that
// several textures show.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "io/bundle.h"
#include "io/plugin_references.h"
#include "io/plugin_tree.h"
#include "textures/texture_description.h"

namespace fluxfarm {

class TextureReader {
 public:
  enum class Images { kRead, kCheckOnly };  // kCheckOnly: that the files are there, for textures that nothing uses

  // Appends to `textures`, which must outlive the reader, as must the plugin tree.
  TextureReader(const PluginsById& plugins, const Bundle& bundle, Images images, std::vector<TextureDescription>& textures)
      : plugins_(plugins), bundle_(bundle), images_(images), textures_(textures) {}

  // Index of a texture, or of the texture that a reference means. Throws SceneError.
  int read(const PluginNode& texture_or_reference);

  // Whether that texture has slopes: an interpolated image, no squares, no nearest texels.
  bool is_smooth(int texture) const;

  bool has_read(const PluginNode& texture) const { return indices_.count(&texture) != 0; }

 private:
  BitmapDescription read_bitmap(const PluginNode& node);
  std::shared_ptr<const TextureImage> image(const std::filesystem::path& file, bool raw);

  const PluginsById& plugins_;
  const Bundle& bundle_;
  Images images_;
  std::vector<TextureDescription>& textures_;
  std::unordered_map<const PluginNode*, int> indices_;
  std::map<std::pair<std::filesystem::path, bool>, std::shared_ptr<const TextureImage>> images_read_;
  std::size_t pixels_ = 0;  // of all images read
};

}  // namespace fluxfarm
