// [T.81] ITU-T T.81 | ISO/IEC 10918-1, annex B: markers and the frame header.
#include "io/jpeg_size.h"

#include <fstream>

namespace fluxfarm {
namespace {

// Two bytes, the high one first; negative at the end of the file.
int take_16(std::istream& stream) {
  const int high = stream.get(), low = stream.get();
  return high < 0 || low < 0 ? -1 : high * 256 + low;
}

// SOF0 to SOF15 without DHT, JPG and DAC, which stand among them.                                    [T.81, table B.1]
bool starts_frame(int marker) { return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc; }

}  // namespace

JpegSize jpeg_size(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  stream.ignore(2);  // start of image
  while (stream.get() == 0xff) {
    int marker = stream.get();
    while (marker == 0xff) marker = stream.get();  // fill bytes
    const int length = take_16(stream);
    if (marker < 0 || length < 2) break;
    if (starts_frame(marker)) {
      stream.ignore(1);  // sample precision
      const int height = take_16(stream), width = take_16(stream);
      return {width, height};
    }
    stream.ignore(length - 2);
  }
  return {};
}

}  // namespace fluxfarm
