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

// The next marker; bytes that belong to none are passed over, as the decoder does. Negative at the end of the file.
int take_marker(std::istream& stream) {
  for (int byte = stream.get(); byte >= 0; byte = stream.get()) {
    if (byte != 0xff) continue;
    while (byte == 0xff) byte = stream.get();  // fill bytes
    if (byte != 0) return byte;
  }
  return -1;
}

constexpr int kEndOfImage = 0xd9;

// TEM and RST0 to RST7: no length follows.                                                           [T.81, table B.1]
bool stands_alone(int marker) { return marker == 0x01 || (marker >= 0xd0 && marker <= 0xd7); }

// SOF0 to SOF15 without DHT, JPG and DAC, which stand among them.                                    [T.81, table B.1]
bool starts_frame(int marker) { return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc; }

}  // namespace

JpegSize jpeg_size(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  stream.ignore(2);  // start of image
  for (int marker = take_marker(stream); marker > 0 && marker != kEndOfImage; marker = take_marker(stream)) {
    if (stands_alone(marker)) continue;
    const int length = take_16(stream);
    if (length < 2) break;
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
