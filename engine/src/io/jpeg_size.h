// The size of a JPEG image from its frame header, without decoding anything.
#pragma once

#include <cstdint>
#include <filesystem>

namespace fluxfarm {

struct JpegSize {
  std::int64_t width = 0, height = 0;  // 0 x 0 if there is no frame header
};

JpegSize jpeg_size(const std::filesystem::path& file);

}  // namespace fluxfarm
