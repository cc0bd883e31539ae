// Orthonormal frame around a normal; local directions have z along the normal.
#pragma once

#include <cmath>

#include "math/vec.h"

namespace fluxfarm {

// [Duff17] T. Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
struct Frame {
  Vec3f s{1, 0, 0}, t{0, 1, 0}, n{0, 0, 1};

  Frame() = default;  // the axes of the world
  // `normal` must have unit length.                                                        [Duff17, listing 3]
  explicit Frame(Vec3f normal) : Frame(normal, std::copysign(1.0f, normal.z)) {}
  // The frames jump where n.z changes its sign. These are the ones of the side of `sign`, 1 or -1, and go on smoothly beyond it,
  // but not to the other pole. They come from the pole by the least turn: where n is t from it, and moves by d, they turn by d /
  // cos(t / 2) at most.
  Frame(Vec3f normal, float sign) : n(normal) {
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    s = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
    t = {b, sign + n.y * n.y * a, -n.y};
  }

  Vec3f to_local(Vec3f world) const { return {dot(world, s), dot(world, t), dot(world, n)}; }
  Vec3f to_world(Vec3f local) const { return s * local.x + t * local.y + n * local.z; }
};

}  // namespace fluxfarm
