// Fuzzes the reader of Mitsuba's XML.
#include "read_as.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fluxfarm::fuzz::read_as("scene.xml", data, size);
  return 0;
}
