// Images for textures: EXR, HDR (Radiance), PNG and JPEG, told apart by their first bytes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "textures/texture_image.h"

namespace fluxfarm {

// Linear Rec.709: bytes and 16-bit integers are decoded from sRGB unless `raw`, floats are taken as they are. Alpha is left out;
// one channel, or one with alpha, is grey. `name` is the file as messages show it.
//
// Throws SceneError for a file that is none of these, is damaged, is deep or has a depth, has too many pixels (kMaxImageSide,
// kMaxImagePixels; checked before memory is taken) or other channels, and for texels that are no reflectance: outside [0, 1] or not
// a number. ResourceError if libfluxfarm-images.so is not beside the engine.
TextureImage read_image(const std::filesystem::path& file, const std::string& name, bool raw);

struct ImageAndAlpha {
  TextureImage colors;
  std::optional<TextureImage> alpha;  // grey, as stored; nothing if the image has none
};

// The same with the alpha channel, from one decoding; colours are not raw. Throws as read_image().
ImageAndAlpha read_image_and_alpha(const std::filesystem::path& file, const std::string& name);

}  // namespace fluxfarm
