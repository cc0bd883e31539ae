#include "io/envmap_image.h"

#include <ImfTestFile.h>

#include <cmath>

#include "io/exr.h"
#include "io/limits.h"
#include "io/open_image.h"
#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

void check_kind(const std::filesystem::path& file, const std::string& name) {
  bool tiled = false, deep = false, multi_part = false;
  if (!Imf::isOpenExrFile(file.c_str(), tiled, deep, multi_part)) {
    throw SceneError(name, "is no image for an envmap, expected OpenEXR or HDR");
  }
  if (deep) throw SceneError(name, "is a deep OpenEXR image, expected a flat one");
}

Image read_exr_image(const std::filesystem::path& file, const std::string& name) {
  try {
    // Luminance with chroma (RY, BY) is asked for so that it fails and does not pass as grey.
    return read_exr(file, {"R", "G", "B", "Y", "RY", "BY"});
  } catch (const ResourceError& error) {
    // The file belongs to the scene: its own name, not the machine's, and trying again is useless.
    std::string text = error.what();
    const std::string path = file.string();
    for (std::size_t at = text.find(path); at != std::string::npos; at = text.find(path, at + name.size())) {
      text.replace(at, path.size(), name);
    }
    throw SceneError(printable(text));
  }
}

std::string size_text(int width, int height) { return std::to_string(width) + " x " + std::to_string(height) + " pixels"; }

void check_least_size(int width, int height, const std::string& name) {
  if (width < 2 || height < 3) {
    throw SceneError(name, "has " + size_text(width, height) + ", expected at least 2 x 3 for an envmap");
  }
}

void check_size(const Image& image, const std::string& name) {
  const PixelRect& rect = image.data_window;
  if (rect.width != image.width || rect.height != image.height) {
    throw SceneError(name, "holds " + size_text(rect.width, rect.height) + " of a frame of " +
                               size_text(image.width, image.height) + ", expected the whole frame");
  }
  check_least_size(rect.width, rect.height, name);
}

[[noreturn]] void fail_at(std::size_t pixel, int width, const char* channel, float value, const std::string& name) {
  const std::size_t columns = static_cast<std::size_t>(width);
  throw SceneError(name, "pixel (" + std::to_string(pixel % columns) + ", " + std::to_string(pixel / columns) + "): " + channel +
                             " = " + number_text(static_cast<double>(value)) + ", expected a finite number of at least 0");
}

// The values of that channel, each a radiance.
const std::vector<float>* checked_channel(const Image& image, const char* channel, const std::string& name) {
  const std::vector<float>* values = image.find(channel);
  for (std::size_t i = 0; values && i < values->size(); ++i) {
    const float value = (*values)[i];
    if (std::isfinite(value) && value >= 0) continue;
    fail_at(i, image.width, channel, value, name);
  }
  return values;
}

LatLongImage read_hdr(ImageFile& file, const std::string& name) {
  const ImageHeader& header = file.header();
  if (header.width > kMaxImageSide || header.height > kMaxImageSide || header.width * header.height > kMaxImagePixels) {
    throw SceneError(name, "the image has " + std::to_string(header.width) + " x " + std::to_string(header.height) +
                               " pixels, expected sides of at most " + std::to_string(kMaxImageSide) + " and at most " +
                               std::to_string(kMaxImagePixels) + " pixels");
  }
  LatLongImage result{static_cast<int>(header.width), static_cast<int>(header.height), {}};
  check_least_size(result.width, result.height, name);
  if (header.turned) throw SceneError(name, "is stored turned or mirrored, expected rows from the top and from the left (-Y +X)");
  if (header.channels.size() != 3) throw SceneError(name, "has no three channels, expected R, G and B");
  result.pixels.resize(static_cast<std::size_t>(header.width * header.height));
  static_assert(sizeof(Rgb) == 3 * sizeof(float));
  file.read(0, 3, &result.pixels.front().r);
  for (std::size_t i = 0; i < result.pixels.size(); ++i) {
    const Rgb& pixel = result.pixels[i];
    for (const auto& [channel, value] : {std::pair{"R", pixel.r}, {"G", pixel.g}, {"B", pixel.b}}) {
      if (!(std::isfinite(value) && value >= 0)) fail_at(i, result.width, channel, value, name);
    }
  }
  return result;
}

LatLongImage read_hdr(const std::filesystem::path& file, const std::string& name) {
  try {
    return read_hdr(*open_image(file, "hdr"), name);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw ResourceError(name + ": not enough memory for the image");
  } catch (const std::exception& error) {
    throw SceneError(name, "is a damaged hdr image: " + printable(error.what()));
  }
}

}  // namespace

LatLongImage read_envmap_image(const std::filesystem::path& file, const std::string& name) {
  // Radiance's format goes through the module for images; OpenEXR has a reader of our own, which loads no other library.
  if (image_format_of(file) == "hdr") return read_hdr(file, name);
  check_kind(file, name);
  const Image image = read_exr_image(file, name);
  check_size(image, name);
  const auto* red = checked_channel(image, "R", name);
  const auto* green = checked_channel(image, "G", name);
  const auto* blue = checked_channel(image, "B", name);
  if (!red && !green && !blue) red = green = blue = checked_channel(image, "Y", name);
  if (!red || !green || !blue) throw SceneError(name, "lacks a channel, expected R, G and B, or Y alone");

  LatLongImage result{image.width, image.height, {}};
  result.pixels.reserve(red->size());
  for (std::size_t i = 0; i < red->size(); ++i) result.pixels.push_back({(*red)[i], (*green)[i], (*blue)[i]});
  return result;
}

}  // namespace fluxfarm
