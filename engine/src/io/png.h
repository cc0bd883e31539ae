// PNG previews: the beauty of an image as a screen shows it.
#pragma once

#include <cstdint>
#include <filesystem>

#include "film/image.h"

namespace fluxfarm {

// Linear light to the 8 bits of sRGB (IEC 61966-2-1), clamped to [0, 1]; NaN gives 0.
std::uint8_t srgb_byte(float linear);

// Writes the channels R, G, B over the data window, 8 bit, without tone mapping. Throws ResourceError if the file cannot be
// written, SettingError if the image lacks one of the channels.
void write_png(const std::filesystem::path& path, const Image& image);

}  // namespace fluxfarm
