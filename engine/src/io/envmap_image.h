// The image of an envmap: OpenEXR or HDR (Radiance), checked before anything is lit by it.
#pragma once

#include <filesystem>
#include <string>

#include "scene/description.h"

namespace fluxfarm {

// Reads the channels R, G and B, or Y alone as a grey, of a file found by a Bundle. Throws SceneError that calls it `name`:
// neither, a deep or damaged one, a part of a larger frame, smaller than 2 x 3 pixels, or a value that is negative or not finite.
LatLongImage read_envmap_image(const std::filesystem::path& file, const std::string& name);

}  // namespace fluxfarm
