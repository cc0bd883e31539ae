// Where a ray met a surface, and what shading needs to know about the place. World frame.
#pragma once

#include <cstdint>

#include "math/vec.h"

namespace fluxfarm {

// What the ray accelerator answers.
struct Hit {
  static constexpr std::uint32_t kNone = 0xffffffffu;

  float t = 0;
  std::uint32_t shape = 0;      // index of the shape in the scene
  std::uint32_t primitive = 0;  // triangle of the mesh; 0 for other shapes
  float u = 0, v = 0;           // barycentric weights of the triangle's second and third vertex
};

struct SurfacePoint {
  Vec3f position;
  Vec3f geometric_normal;  // unit, on the front side of the surface
  Vec3f shading_normal;    // unit, on the front side
};

}  // namespace fluxfarm
