// Bounds of the rays on which light leaves a part of an emitter, and whether they may meet a ball: what a projection map asks.
//
// [Jensen96] H. W. Jensen, "Global Illumination using Photon Maps", EGWR 1996: projection maps.
#pragma once

#include <variant>
#include <vector>

#include "geometry/shape.h"
#include "math/frame.h"
#include "sampling/warp_bounds.h"

namespace fluxfarm {

// A part of an emitter, as the random numbers that Emitter::emit() takes.
struct EmissionCell {
  UnitBox point, direction;

  double measure() const {  // of all [0,1)^4
    const Vec2f p = point.size(), d = direction.size();
    return static_cast<double>(p.x) * static_cast<double>(p.y) * static_cast<double>(d.x) * static_cast<double>(d.y);
  }
};

// Rays that start in a ball, in the directions of a cone.
class NearRays {
 public:
  // `turn` (rad): part of the half angle of the cone that comes from the choice of the point.
  NearRays(const Ball& origins, const Cone& directions, float turn = 0);

  bool may_meet(const Ball& ball) const;
  // How far the choice of the point, and of the direction, moves such a ray at `place`, m.
  float point_blur(Vec3f place) const { return origins_.radius + turn_ * length(place - origins_.center); }
  float direction_blur(Vec3f place) const { return (directions_.half_angle - turn_) * length(place - origins_.center); }

 private:
  Ball origins_;
  Cone directions_;
  float turn_;
  double cos_, sin_;  // of the half angle
};

// Rays from outside of the scene, through a part of the disk that a sphere around it shows to them.
struct DistantRays {
  Frame frame;             // n goes with the light
  float turn = 0;          // rad, frames of the directions differ from `frame` by a rotation of at most so much
  Vec3f scene_center;      // the middle of the disk
  Vec2f place;             // in the frame's s and t, m from the middle
  float place_radius = 0;  // m

  bool may_meet(const Ball& ball) const;
  float point_blur(Vec3f) const { return place_radius; }
  float direction_blur(Vec3f at) const { return std::min(turn, 2.0f) * length(at - scene_center); }
};

// Every ray belongs to one of them at least.
using EmissionBounds = std::vector<std::variant<NearRays, DistantRays>>;

// Of emitted_by() for the points of `area`; `box` is of u_direction.
EmissionBounds bounds_emitted_by(const AreaBounds& area, bool both_sides, UnitBox box);
// Of emitted_from_outside() for directions in a cone; `box` is of u_point.
EmissionBounds bounds_emitted_from_outside(const Cone& directions, Vec3f scene_center, float scene_radius, const UnitBox& box);

}  // namespace fluxfarm
