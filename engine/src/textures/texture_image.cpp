#include "textures/texture_image.h"

#include <cmath>
#include <utility>

#include "support/check.h"

namespace fluxfarm {
namespace {

std::size_t values(int width, int height, int channels) {
  FLUXFARM_CHECK(width > 0 && height > 0 && (channels == 1 || channels == 3), "the reader checks images");
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * static_cast<std::size_t>(channels);
}

}  // namespace

float srgb_to_linear(float encoded) {
  const double e = static_cast<double>(encoded);
  return static_cast<float>(e <= 0.04045 ? e / 12.92 : std::pow((e + 0.055) / 1.055, 2.4));
}

TextureImage::TextureImage(int width, int height, int channels, std::vector<std::uint8_t> texels, bool srgb)
    : width_(width), height_(height), channels_(static_cast<std::size_t>(channels)), bytes_(std::move(texels)) {
  FLUXFARM_CHECK(bytes_.size() == values(width, height, channels), "one value a channel and texel");
  for (std::size_t i = 0; i < decoded_.size(); ++i) {
    const float encoded = static_cast<float>(i) / 255;
    decoded_[i] = srgb ? srgb_to_linear(encoded) : encoded;
  }
}

TextureImage::TextureImage(int width, int height, int channels, std::vector<float> texels)
    : width_(width), height_(height), channels_(static_cast<std::size_t>(channels)), floats_(std::move(texels)) {
  FLUXFARM_CHECK(floats_.size() == values(width, height, channels), "one value a channel and texel");
}

}  // namespace fluxfarm
