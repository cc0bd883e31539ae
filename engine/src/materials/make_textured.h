// From the descriptions of materials with textures to what gives their Bsdf at a hit.
#pragma once

#include <memory>
#include <vector>

#include "materials/material_description.h"
#include "materials/textured_material.h"
#include "textures/make_texture.h"

namespace fluxfarm {

// One entry for each description, in the same order: null where nothing has a texture. `bsdfs` are those of the same descriptions;
// they and the textures are borrowed.
std::vector<std::unique_ptr<TexturedMaterial>> make_textured_materials(const std::vector<MaterialDescription>& descriptions,
                                                                       const std::vector<std::unique_ptr<Bsdf>>& bsdfs,
                                                                       const Textures& textures);

}  // namespace fluxfarm
