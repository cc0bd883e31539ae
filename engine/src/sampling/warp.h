// Maps from the unit square to the shapes that Monte Carlo needs, each with its density.
//
// Every map is continuous and area-preserving up to its density, so stratified points stay stratified. A density is zero outside
// the shape; the measure is said at each one. Directions have z along the axis of the shape.
//
// [Shirley97] P. Shirley and K. Chiu, "A Low Distortion Map Between Disk and Square", JGT 2(3), 1997.
// [Heitz19]   E. Heitz, "A Low-Distortion Map Between Triangle and Square", tech. report hal-02073696, 2019.
#pragma once

#include <cmath>

#include "math/vec.h"

namespace fluxfarm {

// Sine and cosine of an angle in [-pi/4, pi/4], to 1e-7: Taylor polynomials, the same bits on every machine.
struct SinCos {
  float sin, cos;
};
inline SinCos sin_cos_octant(float angle) {
  const float x2 = angle * angle;
  const float s = angle * (1 + x2 * (-1.0f / 6 + x2 * (1.0f / 120 + x2 * (-1.0f / 5040 + x2 * (1.0f / 362880)))));
  const float c = 1 + x2 * (-0.5f + x2 * (1.0f / 24 + x2 * (-1.0f / 720 + x2 * (1.0f / 40320))));
  return {s, c};
}

// Unit disk, concentric map [Shirley97]. x^2 + y^2 of the result is uniform on [0,1]; it may exceed 1 by rounding.
inline Vec2f square_to_uniform_disk(Vec2f u) {
  const float x = 2 * u.x - 1, y = 2 * u.y - 1;
  // Choices by value and not by branch: which triangle a point falls into cannot be guessed.
  const bool wide = std::abs(x) > std::abs(y);
  const float radius = wide ? x : y;
  const SinCos a = sin_cos_octant((kPi / 4) * (wide ? y : x) / (radius == 0 ? 1.0f : radius));
  const float along = radius * a.cos, across = radius * a.sin, w = wide ? 1.0f : 0.0f;
  return {w * along + (1 - w) * across, w * across + (1 - w) * along};
}
// Per unit area.
inline float square_to_uniform_disk_pdf(Vec2f p) { return p.x * p.x + p.y * p.y <= 1 ? kInvPi : 0.0f; }

// Hemisphere z >= 0 in proportion to z: the disk, projected up. z is exactly 0 for points on the rim only.
inline Vec3f square_to_cosine_hemisphere(Vec2f u) {
  const Vec2f p = square_to_uniform_disk(u);
  return {p.x, p.y, safe_sqrt(1 - p.x * p.x - p.y * p.y)};
}
// Per steradian.
inline float square_to_cosine_hemisphere_pdf(Vec3f w) { return w.z > 0 ? w.z * kInvPi : 0.0f; }

// Cap of the sphere around +z down to z = 1 - height, by Lambert's equal-area projection of the disk. Takes the height where it is
// so small that its cosine has lost it.
inline Vec3f square_to_uniform_cap(Vec2f u, float height) {
  const Vec2f p = square_to_uniform_disk(u);
  const float depth = std::min(p.x * p.x + p.y * p.y, 1.0f) * height;  // 1 - z
  const float scale = safe_sqrt(height * (2 - depth));                 // sin(theta) over the radius in the disk
  return {p.x * scale, p.y * scale, 1 - depth};
}

// Down to z = cos_max.
inline Vec3f square_to_uniform_cone(Vec2f u, float cos_max) { return square_to_uniform_cap(u, 1 - cos_max); }
// Per steradian; cos_max < 1.
inline float square_to_uniform_cone_pdf(Vec3f w, float cos_max) { return w.z >= cos_max ? 1 / (kTwoPi * (1 - cos_max)) : 0.0f; }

inline Vec3f square_to_uniform_hemisphere(Vec2f u) { return square_to_uniform_cone(u, 0); }
// Per steradian.
inline float square_to_uniform_hemisphere_pdf(Vec3f w) { return w.z >= 0 ? 0.5f * kInvPi : 0.0f; }

inline Vec3f square_to_uniform_sphere(Vec2f u) { return square_to_uniform_cone(u, -1); }
// Per steradian.
inline float square_to_uniform_sphere_pdf(Vec3f) { return 0.25f * kInvPi; }

// Barycentric coordinates (b0, b1) of a point of a triangle; the third is 1 - b0 - b1. Two halves of the square, each mapped
// linearly [Heitz19].
inline Vec2f square_to_uniform_triangle(Vec2f u) {
  if (u.y > u.x) {
    const float b0 = 0.5f * u.x;
    return {b0, u.y - b0};
  }
  const float b1 = 0.5f * u.y;
  return {u.x - b1, b1};
}
// Per unit of barycentric area (b0, b1); divide by twice the area of the triangle for a density per m^2.
inline float square_to_uniform_triangle_pdf(Vec2f b) { return b.x >= 0 && b.y >= 0 && b.x + b.y <= 1 ? 2.0f : 0.0f; }

}  // namespace fluxfarm
