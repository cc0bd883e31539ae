#include "io/transform_checks.h"

#include <array>
#include <cmath>

namespace fluxfarm {
namespace {

using Column = std::array<double, 3>;

Column column(const Transform& transform, std::size_t j) {
  const auto& m = transform.matrix();
  return {m[0][j], m[1][j], m[2][j]};
}

double dot_product(const Column& a, const Column& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

}  // namespace

double axis_scale(const Transform& transform, std::size_t axis) {
  const Column a = column(transform, axis);
  return std::sqrt(dot_product(a, a));
}

bool keeps_shape(const Transform& transform, std::size_t count) {
  constexpr double kTolerance = 1e-3;  // Mitsuba's
  const double squared = dot_product(column(transform, 0), column(transform, 0));
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      const double expected = a == b ? squared : 0;
      if (std::abs(dot_product(column(transform, a), column(transform, b)) - expected) > kTolerance * squared) return false;
    }
  }
  return squared > 0;
}

}  // namespace fluxfarm
