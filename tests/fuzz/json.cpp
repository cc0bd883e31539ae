// Fuzzes the reader of the JSON form of the plugin tree.
#include "read_as.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fluxfarm::fuzz::read_as("scene.json", data, size);
  return 0;
}
