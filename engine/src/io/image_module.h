// What the engine and libfluxfarm-images.so say to each other. The module is the only place with OpenImageIO and is loaded for the
// first image: linked into the engine, the library would cost every process its start and memory, also for scenes without images.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace fluxfarm {

enum class ImageSample { kUint8, kUint16, kFloat };

// As the file says; nothing of it is trusted yet.
struct ImageHeader {
  std::int64_t width = 0, height = 0, depth = 0;
  std::vector<std::string> channels;  // names in the order of the file
  ImageSample sample = ImageSample::kFloat;
  bool deep = false;
  bool turned = false;  // rows do not run from the top, or not from the left
};

// An open image. Throws std::runtime_error with the decoder's own words.
class ImageFile {
 public:
  virtual ~ImageFile() = default;

  virtual const ImageHeader& header() const = 0;
  // Channels [first, first + count) of all texels, row by row from the top. Integers become bytes, or floats in [0,1].
  virtual void read(int first, int count, std::uint8_t* texels) = 0;
  virtual void read(int first, int count, float* texels) = 0;
};

// Opens `path` with the decoder of `format`: "openexr", "hdr", "png" or "jpeg". The caller owns the result.
using OpenImageFunction = ImageFile* (*)(const char* path, const char* format);
inline constexpr const char* kOpenImageFunction = "fluxfarm_open_image";
inline constexpr const char* kImageModule = "libfluxfarm-images.so";

}  // namespace fluxfarm
