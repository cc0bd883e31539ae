// Second derivatives of the irradiance of surfaces that all shine alike, from where they are and how they stand: visibility is
// taken not to change.
//
// [Jarosz12] W. Jarosz, V. Schoenefeld, L. Kobbelt, H. W. Jensen, "Theory, Analysis and Applications of 2D Global Illumination",
// ACM TOG 31(5), 2012. The formulas here are our own.
#pragma once

#include <algorithm>
#include <cmath>

#include "integrators/irradiance/edge_irradiance.h"
#include "symmetric_matrix.h"

namespace fluxfarm::ablation {

// Of what a small patch sends to a receiver, over that: in the receiver's frame, z along its normal, m^-2. `direction`: to the
// patch, unit; `distance`: m; `normal`: of the patch, unit, on the side of the receiver.
//
// With v from the receiver at x to the patch at y, n the receiver's normal and m the patch's, it sends (n . v) (-m . v) / v^4. A
// step in the tangent plane leaves n . v as it is, so that the Hessian over the value is
//   4 (m_i v_j + m_j v_i) / ((-m . v) v^2) + 24 v_i v_j / v^4 - 4 delta_ij / v^2.
inline TangentMatrix patch_hessian(Vec3f direction, float distance, Vec3f normal) {
  constexpr float kLeastCosine = 1e-3f;  // flatter patches have no part that single precision could tell
  const auto per_squared = 1 / (static_cast<double>(distance) * static_cast<double>(distance));
  const auto cosine = static_cast<double>(std::max(-dot(normal, direction), kLeastCosine));
  const auto x = static_cast<double>(direction.x), y = static_cast<double>(direction.y), mx = static_cast<double>(normal.x),
             my = static_cast<double>(normal.y);
  return {per_squared * (8 * mx * x / cosine + 24 * x * x - 4), per_squared * (4 * (mx * y + my * x) / cosine + 24 * x * y),
          per_squared * (8 * my * y / cosine + 24 * y * y - 4)};
}

// Over the irradiance, m^-2, of cosine-weighted patches.
struct GeometricHessian {
  TangentMatrix sum;    // surfaces around the place balance each other: zero in a room where nothing hides
  TangentMatrix bound;  // of the absolute parts: none balances another, so that any of them may be the one that shines

  void add(const TangentMatrix& patch, double weight) {
    ablation::add(sum, patch, weight);
    ablation::add(bound, absolute(patch), weight);
  }
};

}  // namespace fluxfarm::ablation
