// Symmetric matrices over a tangent plane by their axes.
#pragma once

#include <cmath>

#include "integrators/irradiance/edge_irradiance.h"

namespace fluxfarm::ablation {

inline void add(TangentMatrix& sum, const TangentMatrix& m, double scale) {
  sum.xx += m.xx * scale;
  sum.xy += m.xy * scale;
  sum.yy += m.yy * scale;
}

// The matrix of the same axes with f(eigenvalue) for each eigenvalue.
template <typename Function>
TangentMatrix with_eigenvalues(const TangentMatrix& m, const Function& f) {
  const double middle = (m.xx + m.yy) / 2, half = (m.xx - m.yy) / 2, spread = std::hypot(half, m.xy);
  const double larger = f(middle + spread), smaller = f(middle - spread);
  if (!(spread > 0)) return {larger, 0, larger};
  const double mean = (larger + smaller) / 2, scale = (larger - smaller) / (2 * spread);
  return {mean + scale * half, scale * m.xy, mean - scale * half};
}

inline TangentMatrix absolute(const TangentMatrix& m) {
  return with_eigenvalues(m, [](double value) { return std::fabs(value); });
}

}  // namespace fluxfarm::ablation
