#include "io/envmap_image.h"

#include <ImfTestFile.h>

#include <cmath>

#include "io/exr.h"
#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

void check_kind(const std::filesystem::path& file, const std::string& name) {
  bool tiled = false, deep = false, multi_part = false;
  if (!Imf::isOpenExrFile(file.c_str(), tiled, deep, multi_part)) {
    throw SceneError(name, "is no OpenEXR image, expected one for an envmap");
  }
  if (deep) throw SceneError(name, "is a deep OpenEXR image, expected a flat one");
}

Image read_image(const std::filesystem::path& file, const std::string& name) {
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

void check_size(const Image& image, const std::string& name) {
  const PixelRect& rect = image.data_window;
  if (rect.width != image.width || rect.height != image.height) {
    throw SceneError(name, "holds " + size_text(rect.width, rect.height) + " of a frame of " +
                               size_text(image.width, image.height) + ", expected the whole frame");
  }
  if (rect.width < 2 || rect.height < 3) {
    throw SceneError(name, "has " + size_text(rect.width, rect.height) + ", expected at least 2 x 3 for an envmap");
  }
}

// The values of that channel, each a radiance.
const std::vector<float>* checked_channel(const Image& image, const char* channel, const std::string& name) {
  const std::vector<float>* values = image.find(channel);
  for (std::size_t i = 0; values && i < values->size(); ++i) {
    const float value = (*values)[i];
    if (std::isfinite(value) && value >= 0) continue;
    const auto width = static_cast<std::size_t>(image.width);
    throw SceneError(name, "pixel (" + std::to_string(i % width) + ", " + std::to_string(i / width) + "): " + channel + " = " +
                               number_text(static_cast<double>(value)) + ", expected a finite number of at least 0");
  }
  return values;
}

}  // namespace

LatLongImage read_envmap_image(const std::filesystem::path& file, const std::string& name) {
  check_kind(file, name);
  const Image image = read_image(file, name);
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
