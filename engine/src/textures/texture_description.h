// Plain description of a texture: what the scene file says, with the texels of its image. No behaviour.
#pragma once

#include <memory>
#include <variant>

#include "math/rgb.h"
#include "math/transform.h"
#include "textures/texture_image.h"

namespace fluxfarm {

// Two by two squares in the unit square of uv: color0 where u and v are both in their lower half or both in their upper half.
struct CheckerboardDescription {
  Rgb color0{0.4f};
  Rgb color1{0.2f};
  Transform to_uv;  // applied to (u, v, 0)
};

enum class TextureFilter { kBilinear, kNearest };
enum class TextureWrap { kRepeat, kMirror, kClamp };

struct BitmapDescription {
  std::shared_ptr<const TextureImage> image;  // shared by all textures that show it; null in a description that was only checked
  TextureFilter filter = TextureFilter::kBilinear;
  TextureWrap wrap = TextureWrap::kRepeat;
  Transform to_uv;  // applied to (u, v, 0)
};

// Colours of the mesh's own vertices, times the scale.
struct MeshAttributeDescription {
  float scale = 1;
};

using TextureDescription = std::variant<CheckerboardDescription, BitmapDescription, MeshAttributeDescription>;

}  // namespace fluxfarm
