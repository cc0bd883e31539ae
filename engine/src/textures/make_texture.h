// From the description of a texture to the Texture that carries it out.
#pragma once

#include <memory>
#include <vector>

#include "textures/texture.h"
#include "textures/texture_description.h"

namespace fluxfarm {

using Textures = std::vector<std::unique_ptr<Texture>>;

// One texture for each description, in the same order. Shares the images.
Textures make_textures(const std::vector<TextureDescription>& descriptions);

}  // namespace fluxfarm
