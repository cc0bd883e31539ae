#include "film/error_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "film/tile_sums.h"
#include "support/check.h"

namespace fluxfarm {
namespace {

constexpr double kRisk = 0.05;

}  // namespace

double ErrorBound::at(int number) const {
  FLUXFARM_CHECK(number >= 1 && pixels_ > 0, "a bound is asked for at a look, of some pixels");
  const double z = gaussian_upper_quantile(std::ldexp(kRisk, -number));
  if (squares_ == 0) return 0.0;
  // Squares of estimated variances are (R + 1) / (R - 1) times too large in the mean. That is left in: where few pixels carry the
  // error, their number is itself uncertain.
  const double carriers = sum_ * sum_ / squares_;
  return std::sqrt(estimate() * f_upper_quantile(carriers, (kFilmReplicates - 1) * carriers, z));
}

double f_upper_quantile(double n, double m, double z) {
  // The cube root of a chi-square variable is nearly Gaussian; the quantile's cube root solves a quadratic equation.
  const double vn = 2 / (9 * n), vm = 2 / (9 * m);
  const double a = (1 - vm) * (1 - vm) - z * z * vm;
  const double b = (1 - vm) * (1 - vn);
  const double c = (1 - vn) * (1 - vn) - z * z * vn;
  if (a <= 0) return std::numeric_limits<double>::infinity();
  return std::pow((b + std::sqrt(std::max(0.0, b * b - a * c))) / a, 3);
}

double gaussian_upper_quantile(double p) {
  // Newton's method on the logarithm of the tail, which is concave: it converges from any start above the solution.
  double z = std::sqrt(-2 * std::log(p));
  for (int i = 0; i < 20; ++i) {
    const double tail = 0.5 * std::erfc(z / std::numbers::sqrt2);
    const double density = std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
    z += std::log(tail / p) * tail / density;
  }
  return z;
}

}  // namespace fluxfarm
