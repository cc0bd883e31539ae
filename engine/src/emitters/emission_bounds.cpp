#include "emitters/emission_bounds.h"

#include <algorithm>
#include <limits>

namespace fluxfarm {
namespace {

// Rounding must not put a ray outside.
constexpr float kAngleMargin = 4e-6f, kLengthMargin = 1e-5f;  // rad; of the lengths that go in

// Frames as emit() builds them around the normals of a cone, on one side of their jump.
struct Frames {
  Frame middle;
  float turn;  // rad, by which any other is turned against it at most; infinite: nothing is known
};

std::vector<Frames> frames_around(const Cone& normals) {
  const Vec3f n = normals.axis;
  std::vector<Frames> sides;
  for (const float sign : {std::copysign(1.0f, n.z), -std::copysign(1.0f, n.z)}) {
    const float from_pole = std::atan2(std::sqrt(n.x * n.x + n.y * n.y), n.z * sign);
    const float nearest = from_pole - normals.half_angle, farthest = from_pole + normals.half_angle;
    if (sign != std::copysign(1.0f, n.z) && nearest > kPi / 2 + kAngleMargin) continue;
    constexpr float kSmooth = 0.9f * kPi;  // from the pole on whose side they are
    if (farthest > kSmooth) {
      sides.push_back({Frame(n), std::numeric_limits<float>::infinity()});
    } else {
      sides.push_back({Frame(n, sign), normals.half_angle / std::cos(0.5f * farthest)});
    }
    if (normals.half_angle == 0) break;  // the one and only
  }
  return sides;
}

}  // namespace

NearRays::NearRays(const Ball& origins, const Cone& directions, float turn)
    : origins_(origins),
      directions_{directions.axis, std::min(directions.half_angle + kAngleMargin, kPi)},
      turn_(turn),
      cos_(std::cos(static_cast<double>(directions_.half_angle))),
      sin_(std::sin(static_cast<double>(directions_.half_angle))) {}

bool NearRays::may_meet(const Ball& ball) const {
  // A ray from a point of the ball of origins meets `ball` only if one from its middle meets that grown by its radius: if its angle
  // to the axis is at most the half angle h and that of the grown ball, b.
  const Vec3f d = ball.center - origins_.center;
  const auto squared = static_cast<double>(length_squared(d));
  const double reach = static_cast<double>((ball.radius + origins_.radius) * (1 + kLengthMargin) + kLengthMargin * length(d));
  if (!(squared > reach * reach)) return true;
  const double tangent = std::sqrt(squared - reach * reach);  // times cos(b) over the distance
  if (sin_ * tangent + cos_ * reach <= 0) return true;        // h + b is 180 degrees or more
  return static_cast<double>(dot(d, directions_.axis)) >= cos_ * tangent - sin_ * reach;
}

bool DistantRays::may_meet(const Ball& ball) const {
  // Where the ray passes the disk, against where it would have to pass; the turn of the frame moves the latter.
  const Vec3f d = ball.center - scene_center;
  const float distance = length(d);
  const float x = dot(d, frame.s) - place.x, y = dot(d, frame.t) - place.y;
  const float reach = ball.radius + place_radius + std::min(turn, 2.0f) * distance;
  return std::sqrt(x * x + y * y) <= reach * (1 + kLengthMargin) + kLengthMargin * distance;
}

EmissionBounds bounds_emitted_by(const AreaBounds& area, bool both_sides, UnitBox box) {
  Cone normals = area.normals;
  bool any_side = false;
  if (both_sides) {
    const bool back = box.lower.x >= 0.5f;
    any_side = !back && box.upper.x > 0.5f;
    const float shift = back ? 1.0f : 0.0f;
    box.lower.x = 2 * box.lower.x - shift;
    box.upper.x = 2 * box.upper.x - shift;
    if (back) normals.axis = -normals.axis;
  }
  // emitted_by() moves the origin off the surface, by 256 units in the last place of each coordinate.
  constexpr float kOffset = 6e-5f;
  const auto& [center, radius] = area.points;
  const Ball origins{center, radius * (1 + kLengthMargin) + kOffset * (length(center) + radius + 1)};
  if (any_side) return {NearRays(origins, {})};
  const Cone local = cosine_hemisphere_cone(box);
  EmissionBounds bounds;
  for (const Frames& frames : frames_around(normals)) {
    const float half_angle = local.half_angle + frames.turn;
    const float hemisphere = normals.half_angle + kPi / 2;
    if (half_angle < hemisphere) {
      bounds.push_back(NearRays(origins, {frames.middle.to_world(local.axis), half_angle}, frames.turn));
    } else {
      bounds.push_back(NearRays(origins, {normals.axis, std::min(hemisphere, kPi)}, std::min(normals.half_angle, kPi / 2)));
    }
  }
  return bounds;
}

EmissionBounds bounds_emitted_from_outside(const Cone& directions, Vec3f scene_center, float scene_radius, const UnitBox& box) {
  const DiskBounds disk = disk_bounds(box);
  const Vec2f place{scene_radius * disk.center.x, scene_radius * disk.center.y};
  EmissionBounds bounds;
  for (const Frames& frames : frames_around(directions)) {
    bounds.push_back(DistantRays{frames.middle, frames.turn, scene_center, place, scene_radius * disk.radius});
  }
  return bounds;
}

}  // namespace fluxfarm
