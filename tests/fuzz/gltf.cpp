// Fuzzes the reader of glTF, text and binary: it tells them apart by their first bytes.
#include "read_as.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fluxfarm::fuzz::read_as("scene.gltf", data, size);
  return 0;
}
