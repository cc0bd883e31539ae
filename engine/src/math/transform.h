// Affine transform, kept in double precision with its inverse's linear part for normals. Column vectors: p' = M p.
#pragma once

#include <array>

#include "math/vec.h"

namespace fluxfarm {

class Transform {
 public:
  // Row-major 4 x 4.
  using Matrix = std::array<std::array<double, 4>, 4>;

  Transform();  // identity
  // Only affine matrices: the last row is 0 0 0 1.
  explicit Transform(const Matrix& matrix) : m_(matrix) {}

  static Transform translate(double x, double y, double z);
  static Transform scale(double x, double y, double z);
  // Right-handed rotation about `axis` (need not be normalised) by `angle_degrees`.
  static Transform rotate(double x, double y, double z, double angle_degrees);
  // Camera to world: the camera looks along its +z from `origin` to `target`, +y is up, +x to the left (Mitsuba's frame).
  static Transform look_at(const std::array<double, 3>& origin, const std::array<double, 3>& target,
                           const std::array<double, 3>& up);

  // This transform after `first`: (*this * first)(p) = (*this)(first(p)).
  Transform operator*(const Transform& first) const;

  Vec3f point(Vec3f p) const;
  Vec3f vector(Vec3f v) const;
  // Maps a normal by the cofactor matrix; the result is not normalised. Keeps the side for every handedness.
  Vec3f normal(Vec3f n) const;

  // Determinant of the linear part; negative for mirrored frames, zero for a flat one.
  double determinant() const;
  bool is_finite() const;
  const Matrix& matrix() const { return m_; }

 private:
  Matrix m_;
};

}  // namespace fluxfarm
