// One function for each texture. The classes themselves live in the .cpp file of the same name; make_texture.h is the way in from
// outside.
#pragma once

#include <memory>

#include "textures/texture.h"
#include "textures/texture_description.h"

namespace fluxfarm {

std::unique_ptr<Texture> make_checkerboard(const CheckerboardDescription&);
std::unique_ptr<Texture> make_bitmap(const BitmapDescription&);
std::unique_ptr<Texture> make_mesh_attribute(const MeshAttributeDescription&);

}  // namespace fluxfarm
