// Where the maps of warp.h send a box of the unit square: bounds that hold for all of its points.
//
// [Shirley97] P. Shirley and K. Chiu, "A Low Distortion Map Between Disk and Square", JGT 2(3), 1997.
#pragma once

#include <algorithm>
#include <cmath>

#include "math/vec.h"
#include "sampling/warp.h"

namespace fluxfarm {

// Part of [0,1)^2, half-open.
struct UnitBox {
  Vec2f lower{0, 0}, upper{1, 1};

  Vec2f size() const { return {upper.x - lower.x, upper.y - lower.y}; }
  // The point that has the place `u` in [0,1)^2 within the box.
  Vec2f at(Vec2f u) const {
    const Vec2f s = size(), end = last();
    return {std::min(lower.x + s.x * u.x, end.x), std::min(lower.y + s.y * u.y, end.y)};
  }
  // The greatest numbers that belong to it.
  Vec2f last() const { return {std::nextafter(upper.x, 0.0f), std::nextafter(upper.y, 0.0f)}; }
};

// All unit vectors that close to the axis.
struct Cone {
  Vec3f axis{0, 0, 1};     // unit
  float half_angle = kPi;  // rad
};

// Part of a disk or of a sphere around z: what is measured from the middle is a radius, or the angle to the pole, rad.
struct Sector {
  float begin = 0, end = 1;
  float phi = 0, half_phi = kPi;  // azimuth, at most so far from phi, rad
};

// `sector` on the unit sphere.
inline Cone polar_cone(const Sector& sector) {
  // From the middle to a corner, by haversines: hav(d) = hav(theta - theta') + sin(theta) sin(theta') hav(phi - phi').
  const float middle = 0.5f * (sector.begin + sector.end), half = 0.5f * (sector.end - sector.begin);
  const bool crosses_equator = sector.begin < kPi / 2 && sector.end > kPi / 2;
  const float sine = crosses_equator ? 1.0f : std::max(std::sin(sector.begin), std::sin(sector.end));
  const float haversine = sqr(std::sin(0.5f * half)) + std::sin(middle) * sine * sqr(std::sin(0.5f * sector.half_phi));
  constexpr float kMargin = 4e-6f;  // several times the rounding of angles up to pi
  Cone cone{{std::sin(middle) * std::cos(sector.phi), std::sin(middle) * std::sin(sector.phi), std::cos(middle)},
            2 * std::asin(std::sqrt(std::min(haversine * (1 + kMargin), 1.0f)))};
  const Cone around_pole{{0, 0, 1}, sector.end}, around_other_pole{{0, 0, -1}, kPi - sector.begin};
  for (const Cone& other : {around_pole, around_other_pole}) {
    if (other.half_angle < cone.half_angle) cone = other;
  }
  cone.half_angle = std::min(cone.half_angle + kMargin, kPi);
  return cone;
}

// Of square_to_uniform_disk(). The radius is the greater of |x| and |y| of a point of [-1,1]^2; the azimuth grows with the angle of
// (x, y), so that the corners of a box that leaves out the middle have the outermost.                                [Shirley97]
inline Sector disk_sector(const UnitBox& box) {
  const float x0 = 2 * box.lower.x - 1, x1 = 2 * box.upper.x - 1, y0 = 2 * box.lower.y - 1, y1 = 2 * box.upper.y - 1;
  const auto nearest = [](float a, float b) { return a > 0 ? a : b < 0 ? -b : 0.0f; };
  const auto farthest = [](float a, float b) { return std::max(std::fabs(a), std::fabs(b)); };
  constexpr float kMargin = 1e-6f;  // for rounding
  Sector sector{std::max(std::max(nearest(x0, x1), nearest(y0, y1)) - kMargin, 0.0f),
                std::min(std::max(farthest(x0, x1), farthest(y0, y1)) + kMargin, 1.0f)};
  const bool around_middle = x0 < 0 && x1 > 0 && y0 < 0 && y1 > 0;
  if (around_middle) return sector;
  const Vec2f center = square_to_uniform_disk({0.5f * (box.lower.x + box.upper.x), 0.5f * (box.lower.y + box.upper.y)});
  sector.phi = std::atan2(center.y, center.x);
  sector.half_phi = 0;
  for (const float x : {box.lower.x, box.upper.x}) {
    for (const float y : {box.lower.y, box.upper.y}) {
      const Vec2f p = square_to_uniform_disk({x, y});
      if (p.x == 0 && p.y == 0) continue;  // the middle as a corner of the box
      const float turn = std::remainder(std::atan2(p.y, p.x) - sector.phi, kTwoPi);
      sector.half_phi = std::max(sector.half_phi, std::fabs(turn) + kMargin);
    }
  }
  return sector;
}

// `sector` of the unit disk.
struct DiskBounds {
  Vec2f center;
  float radius = 0;
};

inline DiskBounds disk_bounds(const Sector& sector) {
  const float middle = 0.5f * (sector.begin + sector.end), half = 0.5f * (sector.end - sector.begin);
  const float radius = std::sqrt(sqr(half) + 4 * middle * sector.end * sqr(std::sin(0.5f * sector.half_phi)));
  if (radius >= sector.end) return {{}, sector.end};
  return {{middle * std::cos(sector.phi), middle * std::sin(sector.phi)}, radius};
}

// Of square_to_uniform_disk().
inline DiskBounds disk_bounds(const UnitBox& box) { return disk_bounds(disk_sector(box)); }

// Of square_to_cosine_hemisphere().
inline Cone cosine_hemisphere_cone(const UnitBox& box) {
  Sector sector = disk_sector(box);
  sector.begin = std::asin(sector.begin);
  sector.end = std::asin(sector.end);
  return polar_cone(sector);
}

// Of square_to_uniform_cap(), height up to 2.
inline Cone cap_cone(const UnitBox& box, float height) {
  Sector sector = disk_sector(box);
  const float scale = std::sqrt(0.5f * height);  // radius 1 to the sine of half the angle
  sector.begin = 2 * std::asin(std::min(sector.begin * scale, 1.0f));
  sector.end = 2 * std::asin(std::min(sector.end * scale, 1.0f));
  return polar_cone(sector);
}

}  // namespace fluxfarm
