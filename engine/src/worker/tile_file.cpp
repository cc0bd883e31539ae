#include "worker/tile_file.h"

#include <fstream>
#include <string>
#include <system_error>

#include "support/error.h"
#include "worker/codec.h"

namespace fluxfarm {

std::uint64_t write_tile_file(const std::filesystem::path& path, const TileSums& sums) {
  const std::string bytes = encode_tile_sums(sums);
  std::ofstream out(path, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    throw ResourceError(path.string() + ": cannot write the tile, is the disk full?");
  }
  return bytes.size();
}

TileSums read_tile_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  std::string bytes(in ? static_cast<std::size_t>(in.tellg()) : 0, '\0');
  in.seekg(0);
  if (!in.read(bytes.data(), static_cast<std::streamsize>(bytes.size())))
    throw ResourceError(path.string() + ": cannot read the tile");
  return decode_tile_sums(bytes, path.string());
}

}  // namespace fluxfarm
