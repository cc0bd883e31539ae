// What a material that holds others asks at a hit: another material, constant or not; a number, constant or not.
#pragma once

#include "materials/material_description.h"
#include "materials/textured_material.h"
#include "textures/make_texture.h"

namespace fluxfarm {

// Borrows both. `textured` is null where the material is the same everywhere.
struct NestedMaterial {
  const Bsdf* constant = nullptr;
  const TexturedMaterial* textured = nullptr;

  const Bsdf& at(const MaterialPoint& point, BsdfSpace& space) const {
    return textured != nullptr ? textured->add_to(space, point) : *constant;
  }
};

struct TexturedScalar {
  float factor = 0;
  const Texture* texture = nullptr;

  float at(const MaterialPoint& point) const {
    return texture != nullptr ? factor * luminance(texture->value(point.texture)) : factor;
  }
};

}  // namespace fluxfarm
