// One function for each material that may have textures; make_textured.h is the way in from outside.
//
// The textures must outlive the result.
#pragma once

#include <memory>

#include "materials/material_description.h"
#include "materials/nested.h"
#include "materials/textured_material.h"
#include "textures/make_texture.h"

namespace fluxfarm {

std::unique_ptr<TexturedMaterial> make_textured_rough_conductor(const RoughConductorDescription&, const Textures&);
std::unique_ptr<TexturedMaterial> make_textured_plastic(const PlasticDescription&, const Textures&);
std::unique_ptr<TexturedMaterial> make_textured_rough_plastic(const RoughPlasticDescription&, const Textures&);
std::unique_ptr<TexturedMaterial> make_textured_gltf(const GltfDescription&, const Textures&);  // null where nothing varies
std::unique_ptr<TexturedMaterial> make_textured_principled(const PrincipledDescription&, const Textures&);

std::unique_ptr<TexturedMaterial> make_textured_twosided(NestedMaterial front, NestedMaterial back);
std::unique_ptr<TexturedMaterial> make_textured_mask(NestedMaterial covered, TexturedScalar opacity, std::optional<float> cutoff);
std::unique_ptr<TexturedMaterial> make_textured_blend(NestedMaterial first, NestedMaterial second, TexturedScalar weight);
std::unique_ptr<TexturedMaterial> make_normal_map(NestedMaterial nested, const Texture& normals, const NormalMapDescription&);
std::unique_ptr<TexturedMaterial> make_bump_map(NestedMaterial nested, const Texture& height, float scale);

// The texture of that index, or null for kNoTexture.
inline const Texture* texture_of(const Textures& textures, int index) {
  return index == kNoTexture ? nullptr : textures.at(static_cast<std::size_t>(index)).get();
}

// A colour parameter at a hit: its constant factor times its texture, if it has one.
inline Rgb colour_at(Rgb factor, const Texture* texture, const TexturePoint& point) {
  return texture != nullptr ? factor * texture->value(point) : factor;
}

}  // namespace fluxfarm
