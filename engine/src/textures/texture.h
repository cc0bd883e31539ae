// A value that varies over a surface: the seam between materials and where their colours come from.
//
// Semantics are those of Mitsuba 3's textures of the same name: v = 0 is the top row of an image. Looked up at points, without
// footprint: no mip-maps, no ray differentials, so fine images far away cost samples. Objects are immutable and may be used by any
// number of threads.
#pragma once

#include "math/rgb.h"
#include "math/vec.h"

namespace fluxfarm {

// A place of a surface, as textures need to know it.
struct TexturePoint {
  Vec2f uv;
  Rgb vertex_color{};  // of a mesh that has colours, where a texture asks for them
};

class Texture {
 public:
  virtual ~Texture() = default;

  // At texture coordinates uv, any finite numbers; linear Rec.709, dimensionless.
  virtual Rgb value(const TexturePoint& point) const = 0;
  // Change of the luminance per unit of u and of v; 0 for textures that change in steps. Bump maps ask for it.
  virtual Vec2f luminance_gradient(Vec2f) const { return {}; }
  // Over the texture's own unit square, for heuristics. Takes time in proportion to an image's texels: ask while compiling a scene.
  virtual Rgb mean_value() const = 0;
};

}  // namespace fluxfarm
