// Parameters that several materials share: colours and numbers that may be textures, indices of refraction.
#pragma once

#include <string>

#include "io/properties.h"
#include "io/read_texture.h"
#include "materials/material_description.h"

namespace fluxfarm {

// A colour in [0, 1] that may be a texture: then its constant factor is 1 and `texture` its index.
Rgb read_colour(Properties& properties, TextureReader& textures, const std::string& name, Rgb otherwise, int& texture);

// A number in [0, 1] that may be a texture: then its factor is 1.
ScalarParameter read_scalar(Properties& properties, TextureReader& textures, const std::string& name, float otherwise);

// An index of refraction given as a number or by the name of a material.
float read_ior(Properties& properties, const std::string& name, const char* default_name);

// `int_ior` over `ext_ior` (air).
float read_relative_ior(Properties& properties, const char* default_interior);

}  // namespace fluxfarm
