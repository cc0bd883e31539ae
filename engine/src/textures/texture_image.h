// The texels of an image, linear Rec.709 or grey, kept at the size of the file: a byte a channel where the file has bytes.
//
// [IEC61966] IEC 61966-2-1:1999, the sRGB transfer function.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "math/rgb.h"

namespace fluxfarm {

// Linear value of an sRGB-encoded one in [0,1].                                                     [IEC61966]
float srgb_to_linear(float encoded);

class TextureImage {
 public:
  // Row by row from the top, `channels` (1 or 3) values a texel. `srgb`: bytes are encoded so; floats are always linear.
  TextureImage(int width, int height, int channels, std::vector<std::uint8_t> texels, bool srgb);
  TextureImage(int width, int height, int channels, std::vector<float> texels);

  // x in [0, width), y in [0, height) from the top.
  Rgb texel(int x, int y) const {
    const std::size_t i =
        (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)) * channels_;
    const auto channel = [&](std::size_t c) { return bytes_.empty() ? floats_[i + c] : decoded_[bytes_[i + c]]; };
    return channels_ == 1 ? Rgb{channel(0)} : Rgb{channel(0), channel(1), channel(2)};
  }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  int width_, height_;
  std::size_t channels_;
  std::vector<std::uint8_t> bytes_;
  std::vector<float> floats_;  // one of the two is empty
  std::array<float, 256> decoded_{};
};

}  // namespace fluxfarm
