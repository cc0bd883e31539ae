// A tile's sums on disk, between the RenderTiles that writes them and the MergePass that reads them.
#pragma once

#include <cstdint>
#include <filesystem>

#include "film/tile_sums.h"

namespace fluxfarm {

// Returns the length of the file in bytes; it is closed, but not synced. Throws ResourceError, leaving no file, when it cannot be
// written.
std::uint64_t write_tile_file(const std::filesystem::path& path, const TileSums& sums);

// Throws ResourceError when the file cannot be read, is no tile or contradicts itself.
TileSums read_tile_file(const std::filesystem::path& path);

}  // namespace fluxfarm
