#include "io/gltf_texture.h"

#include "io/data_uri.h"
#include "io/limits.h"
#include "io/memory_file.h"
#include "io/read_image.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

constexpr std::uint64_t kNearest = 9728, kClamp = 33071, kMirror = 33648, kRepeat = 10497;

// Of texture coordinates: offset, rotation and scale of KHR_texture_transform, whose rotation is clockwise in (u, v).
Transform uv_transform(const GltfObject& extension) {
  const std::vector<double> offset = extension.numbers("offset", 2, {0, 0}), scale = extension.numbers("scale", 2, {1, 1});
  const double degrees = -extension.number("rotation", 0) * 180 / M_PI;
  return Transform::translate(offset[0], offset[1], 0) * Transform::rotate(0, 0, 1, degrees) *
         Transform::scale(scale[0], scale[1], 1);
}

TextureWrap read_wrap(const GltfObject& sampler, const char* name) {
  const std::uint64_t wrap = sampler.count(name, 65535).value_or(kRepeat);
  if (wrap == kRepeat) return TextureWrap::kRepeat;
  if (wrap == kMirror) return TextureWrap::kMirror;
  if (wrap != kClamp) sampler.fail(name, "expected 10497, 33648 or 33071");
  return TextureWrap::kClamp;
}

}  // namespace

std::optional<GltfTextures::Use> GltfTextures::read(const GltfObject& object, const char* name, GltfChannels channels) {
  const std::optional<GltfObject> info = object.object(name);
  if (!info) return std::nullopt;
  const GltfObject texture = file_.at("textures", info->required_index("index", "textures", file_.size("textures")));
  const auto source = texture.index("source", "images", file_.size("images"));
  if (!source) {
    warn_once(texture.place() + ": has no image that is read (PNG or JPEG); the texture is left out");
    return std::nullopt;
  }
  BitmapDescription bitmap;
  std::uint64_t uv_set = info->count("texCoord", 7).value_or(0);
  if (const auto transform = info->extension("KHR_texture_transform")) {
    bitmap.to_uv = uv_transform(*transform);
    uv_set = transform->count("texCoord", 7).value_or(uv_set);
  }
  read_sampler(texture, bitmap);
  bitmap.image = image(*source, channels);
  if (bitmap.image == nullptr) return std::nullopt;
  textures_.emplace_back(std::move(bitmap));
  return Use{static_cast<int>(textures_.size()) - 1, static_cast<int>(uv_set)};
}

void GltfTextures::read_sampler(const GltfObject& texture, BitmapDescription& bitmap) {
  const auto index = texture.index("sampler", "samplers", file_.size("samplers"));
  if (!index) return;
  const GltfObject sampler = file_.at("samplers", *index);
  bitmap.wrap = read_wrap(sampler, "wrapS");
  if (read_wrap(sampler, "wrapT") != bitmap.wrap) warn_once(sampler.place() + ": wrapT differs from wrapS, which is used for both");
  if (sampler.count("magFilter", 65535).value_or(0) == kNearest) bitmap.filter = TextureFilter::kNearest;
}

void GltfTextures::warn_once(const std::string& warning) {
  if (warned_.insert(warning).second) warnings_.push_back(warning);
}

std::shared_ptr<const TextureImage> GltfTextures::image(std::size_t index, GltfChannels channels) {
  if (!images_.contains({index, channels})) decode(index, channels);
  return images_.at({index, channels});
}

void GltfTextures::decode(std::size_t index, GltfChannels channels) {
  const GltfObject image = file_.at("images", index);
  if (image.has("uri") == image.has("bufferView"))
    throw SceneError(image.place(), "has both or neither of uri and bufferView, expected one of them");
  const std::string uri = image.text("uri", "");
  if (image.has("bufferView")) {
    const MemoryFile memory(file_.buffer_view(image.required_index("bufferView", "bufferViews", file_.size("bufferViews"))));
    decode(index, channels, memory.path(), image.place());
  } else if (is_data_uri(uri)) {
    const MemoryFile memory(data_uri_bytes(uri, image.place() + ".uri"));
    decode(index, channels, memory.path(), image.place());
  } else {
    const std::filesystem::path file = file_.find(uri, image.place() + ".uri");
    decode(index, channels, file, image.place() + " (" + file_of_uri(uri, image.place()) + ")");
  }
  const TextureImage& texels = *images_.at({index, channels == GltfChannels::kAlpha ? GltfChannels::kColors : channels});
  pixels_ += static_cast<std::size_t>(texels.width()) * static_cast<std::size_t>(texels.height());
  if (pixels_ > kMaxTexturePixels) {
    throw SceneError(image.place(), "with this image the textures of the file have " + std::to_string(pixels_) +
                                        " pixels, expected at most " + std::to_string(kMaxTexturePixels));
  }
}

void GltfTextures::decode(std::size_t index, GltfChannels channels, const std::filesystem::path& file, const std::string& name) {
  const auto keep = [&](GltfChannels of, TextureImage&& texels) {
    images_[{index, of}] = std::make_shared<const TextureImage>(std::move(texels));
  };
  if (channels == GltfChannels::kNumbers) return keep(channels, read_image(file, name, true));
  ImageAndAlpha both = read_image_and_alpha(file, name);
  keep(GltfChannels::kColors, std::move(both.colors));
  images_[{index, GltfChannels::kAlpha}] = nullptr;
  if (both.alpha) keep(GltfChannels::kAlpha, std::move(*both.alpha));
}

Rgb GltfTextures::mean(int texture) const {
  const TextureImage& image = *std::get<BitmapDescription>(textures_.at(static_cast<std::size_t>(texture))).image;
  Rgb sum;
  for (int y = 0; y < image.height(); ++y) {
    Rgb row;  // by rows: a single sum in single precision would lose the last texels
    for (int x = 0; x < image.width(); ++x) row += image.texel(x, y);
    sum += row / static_cast<float>(image.width());
  }
  return sum / static_cast<float>(image.height());
}

}  // namespace fluxfarm
