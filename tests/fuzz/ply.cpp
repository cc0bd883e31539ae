// Fuzzes the reader of PLY meshes, and the checks that follow it.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "io/mesh_ply.h"
#include "support/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string file(reinterpret_cast<const char*>(data), size);
  std::vector<std::string> warnings;
  try {
    fluxfarm::finish_mesh(fluxfarm::parse_ply(file, "mesh.ply"), {}, warnings);
  } catch (const fluxfarm::SceneError&) {
  }
  return 0;
}
