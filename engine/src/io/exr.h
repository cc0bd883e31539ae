// OpenEXR files: 32-bit float channels in scan lines, ZIP compressed.
#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "film/image.h"

namespace fluxfarm {

// Writes all channels over the data window; display window and attributes go into the header. Equal images give equal bytes.
// Throws ResourceError if the file cannot be written.
void write_exr(const std::filesystem::path& path, const Image& image);

// Reads every channel as 32-bit float, and the attributes of type string, float and int that are not OpenEXR's own.
// Throws ResourceError if the file cannot be read or is no EXR image.
Image read_exr(const std::filesystem::path& path);
// The same, of the channels only those that `wanted` names, if the file has them.
Image read_exr(const std::filesystem::path& path, const std::set<std::string>& wanted);

}  // namespace fluxfarm
