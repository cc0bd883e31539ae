// Fuzzes what a worker decodes: requests, and the sums of a tile that it reads from a file.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "support/error.h"
#include "worker/codec.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    fluxfarm::decode_request(bytes);
  } catch (const fluxfarm::Error&) {
  }
  try {
    fluxfarm::decode_tile_sums(bytes, "tile");
  } catch (const fluxfarm::ResourceError&) {
  }
  return 0;
}
