#include <png.h>

#include <cmath>
#include <vector>

#include "io/png.h"
#include "support/error.h"

namespace fluxfarm {

std::uint8_t srgb_byte(float linear) {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 255;
  const double encoded = linear <= 0.0031308f ? 12.92 * linear : 1.055 * std::pow(static_cast<double>(linear), 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255 * encoded));
}

void write_png(const std::filesystem::path& path, const Image& image) {
  std::vector<std::uint8_t> bytes(3 * static_cast<std::size_t>(image.data_window.pixels()));
  std::size_t offset = 0;
  for (const char* name : {"R", "G", "B"}) {
    const std::vector<float>* values = image.find(name);
    if (!values) throw SettingError(std::string("a PNG needs the channels R, G and B, the image lacks ") + name);
    for (std::size_t i = 0; i < values->size(); ++i) bytes[3 * i + offset] = srgb_byte((*values)[i]);
    ++offset;
  }
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.data_window.width);
  png.height = static_cast<png_uint_32>(image.data_window.height);
  png.format = PNG_FORMAT_RGB;
  png.flags = PNG_IMAGE_FLAG_FAST;  // a preview, written with every revision
  if (!png_image_write_to_file(&png, path.c_str(), 0, bytes.data(), 0, nullptr)) {
    throw ResourceError(path.string() + ": cannot be written as PNG: " + png.message);
  }
}

}  // namespace fluxfarm
