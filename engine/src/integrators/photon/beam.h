// The space around a piece of a ray in which photons of a medium count for it: a round beam whose radius grows along it.
#pragma once

#include "math/bounds.h"
#include "math/vec.h"

namespace fluxfarm {

// Part of a beam, by the distances from its origin where it begins and ends, m.
struct BeamPart {
  float begin, end;

  bool empty() const { return !(begin <= end); }
};

struct Beam {
  Vec3f origin;     // world, m
  Vec3f direction;  // unit
  float length;     // m, may be infinite
  float radius;     // at the origin, m
  float spread;     // more of it for each m; not negative

  float radius_at(float distance) const { return radius + spread * distance; }

  // Of `part` that from which some of the beam lies below a plane across `axis`, at `plane`, or above it.
  BeamPart below(BeamPart part, int axis, float plane) const {
    return where_at_most(part, direction[axis] - spread, radius + (plane - origin[axis]));
  }
  BeamPart above(BeamPart part, int axis, float plane) const {
    return where_at_most(part, -direction[axis] - spread, radius - (plane - origin[axis]));
  }
  BeamPart part_in(const Bounds& bounds) const {
    BeamPart part{0, length};
    for (int axis = 0; axis < 3; ++axis) part = above(below(part, axis, bounds.upper[axis]), axis, bounds.lower[axis]);
    return part;
  }

 private:
  // Where slope x distance <= bound.
  static BeamPart where_at_most(BeamPart part, float slope, float bound) {
    if (slope > 0) return {part.begin, part.end < bound / slope ? part.end : bound / slope};
    if (slope < 0) return {part.begin > bound / slope ? part.begin : bound / slope, part.end};
    return bound >= 0 ? part : BeamPart{1, 0};
  }
};

}  // namespace fluxfarm
