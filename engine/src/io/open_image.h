// The way to libfluxfarm-images.so, which is loaded for the first image that is opened and kept.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "io/image_module.h"

namespace fluxfarm {

// Name of the decoder for a file's first bytes: "openexr", "hdr", "png" or "jpeg"; empty for anything else.
std::optional<std::string> image_format_of(const std::filesystem::path& file);

// Throws std::runtime_error with the decoder's own words; ResourceError if the module is not beside the engine.
std::unique_ptr<ImageFile> open_image(const std::filesystem::path& file, const std::string& format);

}  // namespace fluxfarm
