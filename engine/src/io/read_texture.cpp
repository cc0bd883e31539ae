#include "io/read_texture.h"

#include "io/limits.h"
#include "io/properties.h"
#include "io/read_image.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

CheckerboardDescription read_checkerboard(const PluginNode& node) {
  Properties properties(node);
  CheckerboardDescription result;
  result.color0 = properties.rgb("color0", result.color0, kUnitInterval);
  result.color1 = properties.rgb("color1", result.color1, kUnitInterval);
  result.to_uv = properties.transform("to_uv");
  properties.finish();
  return result;
}

MeshAttributeDescription read_mesh_attribute(const PluginNode& node) {
  Properties properties(node);
  MeshAttributeDescription result;
  if (!properties.has("name")) properties.fail("name", "lacks the parameter \"name\"");
  if (properties.text("name", "") != "vertex_color") properties.fail("name", "expected vertex_color");
  result.scale = properties.number("scale", 1, kUnitInterval);
  properties.finish();
  return result;
}

TextureFilter read_filter(Properties& properties) {
  const std::string filter = properties.text("filter_type", "bilinear");
  if (filter != "bilinear" && filter != "nearest") properties.fail("filter_type", "expected bilinear or nearest");
  return filter == "nearest" ? TextureFilter::kNearest : TextureFilter::kBilinear;
}

TextureWrap read_wrap(Properties& properties) {
  const std::string wrap = properties.text("wrap_mode", "repeat");
  if (wrap == "repeat") return TextureWrap::kRepeat;
  if (wrap == "mirror") return TextureWrap::kMirror;
  if (wrap != "clamp") properties.fail("wrap_mode", "expected repeat, mirror or clamp");
  return TextureWrap::kClamp;
}

}  // namespace

int TextureReader::read(const PluginNode& texture_or_reference) {
  const PluginNode& node = texture_or_reference.kind == PluginKind::kReference
                               ? referenced(texture_or_reference, PluginKind::kTexture, plugins_)
                               : texture_or_reference;
  if (const auto known = indices_.find(&node); known != indices_.end()) return known->second;
  check_no_children(node);
  if (node.type == "checkerboard") {
    textures_.emplace_back(read_checkerboard(node));
  } else if (node.type == "mesh_attribute") {
    textures_.emplace_back(read_mesh_attribute(node));
  } else {
    textures_.emplace_back(read_bitmap(node));
  }
  return indices_[&node] = static_cast<int>(textures_.size()) - 1;
}

bool TextureReader::is_smooth(int texture) const {
  const auto* bitmap = std::get_if<BitmapDescription>(&textures_[static_cast<std::size_t>(texture)]);
  return bitmap != nullptr && bitmap->filter == TextureFilter::kBilinear;
}

BitmapDescription TextureReader::read_bitmap(const PluginNode& node) {
  Properties properties(node);
  BitmapDescription result;
  if (!properties.has("filename")) properties.fail("filename", "lacks the parameter \"filename\"");
  const std::filesystem::path file = bundle_.find(properties.text("filename", ""), node.place);
  const bool raw = properties.boolean("raw", false);
  result.filter = read_filter(properties);
  result.wrap = read_wrap(properties);
  result.to_uv = properties.transform("to_uv");
  properties.ignore({"format", "accel"});
  properties.finish();
  if (images_ == Images::kRead) result.image = image(file, raw);
  return result;
}

std::shared_ptr<const TextureImage> TextureReader::image(const std::filesystem::path& file, bool raw) {
  std::shared_ptr<const TextureImage>& known = images_read_[{file, raw}];
  if (known) return known;
  known = std::make_shared<const TextureImage>(read_image(file, bundle_.name(file), raw));
  pixels_ += static_cast<std::size_t>(known->width()) * static_cast<std::size_t>(known->height());
  if (pixels_ > kMaxTexturePixels) {
    throw SceneError(bundle_.name(file), "with this image the textures of the scene have " + std::to_string(pixels_) +
                                             " pixels, expected at most " + std::to_string(kMaxTexturePixels));
  }
  return known;
}

}  // namespace fluxfarm
