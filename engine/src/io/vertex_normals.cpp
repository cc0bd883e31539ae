#include "io/vertex_normals.h"

#include <algorithm>
#include <cmath>

namespace fluxfarm {
namespace {

using Vector = std::array<double, 3>;

Vector difference(Vec3f a, Vec3f b) {
  return {static_cast<double>(a.x) - b.x, static_cast<double>(a.y) - b.y, static_cast<double>(a.z) - b.z};
}

Vector cross_product(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double length_of(const Vector& a) { return std::hypot(a[0], a[1], a[2]); }

// Angle between two edges; accurate for small and for flat angles, too.
double angle_between(const Vector& a, const Vector& b) {
  return std::atan2(length_of(cross_product(a, b)), a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
}

}  // namespace

std::array<double, 3> face_normal(Vec3f a, Vec3f b, Vec3f c) { return cross_product(difference(b, a), difference(c, a)); }

void fill_missing_normals(const std::vector<Vec3f>& positions, const std::vector<std::uint32_t>& indices,
                          std::vector<Vec3f>& normals) {
  normals.resize(positions.size());
  const bool complete = std::none_of(normals.begin(), normals.end(), [](Vec3f n) { return n == Vec3f{}; });
  if (complete) return;

  std::vector<Vector> sums(positions.size(), Vector{0, 0, 0}), last_face(positions.size(), Vector{0, 0, 1});
  for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
    Vector n = face_normal(positions[indices[t]], positions[indices[t + 1]], positions[indices[t + 2]]);
    const double n_length = length_of(n);
    for (double& axis : n) axis /= n_length;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t i = indices[t + corner], next = indices[t + (corner + 1) % 3], previous = indices[t + (corner + 2) % 3];
      const double angle = angle_between(difference(positions[next], positions[i]), difference(positions[previous], positions[i]));
      for (std::size_t axis = 0; axis < 3; ++axis) sums[i][axis] += angle * n[axis];
      last_face[i] = n;
    }
  }
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (!(normals[i] == Vec3f{})) continue;
    const bool vanishes = length_of(sums[i]) < 1e-9;  // of angles that add up to radians
    const Vector& n = vanishes ? last_face[i] : sums[i];
    const double n_length = length_of(n);
    normals[i] = {static_cast<float>(n[0] / n_length), static_cast<float>(n[1] / n_length), static_cast<float>(n[2] / n_length)};
  }
}

}  // namespace fluxfarm
