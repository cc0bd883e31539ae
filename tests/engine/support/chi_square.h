// Pearson's chi-square test of samples on the sphere against the density they claim.
//
// The sphere is cut into cells; the expected count of a cell is the integral of the density over it. A sampler may fail (absorbed,
// or a delta lobe was chosen): all failures are one more cell, expected 1 - integral. Cells that expect fewer than five are pooled.
//
// [Sidak67] Z. Sidak, "Rectangular Confidence Regions for the Means of Multivariate Normal Distributions", JASA 62, 1967.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "math/frame.h"
#include "math/vec.h"

namespace fluxfarm::testing {

// Q(a, x) = Gamma(a, x) / Gamma(a): the series of P below a + 1, a continued fraction (modified Lentz) above.
inline double upper_incomplete_gamma(double a, double x) {
  if (x <= 0) return 1;
  const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
  if (x < a + 1) {
    double term = 1 / a, sum = term;
    for (double k = a + 1; term > sum * 1e-15; ++k) sum += term *= x / k;
    return 1 - front * sum;
  }
  double b = x + 1 - a, c = 1e300, d = 1 / b, h = d;
  for (int i = 1; i < 10000; ++i) {
    const double numerator = -i * (i - a);
    b += 2;
    d = 1 / (numerator * d + b);
    c = b + numerator / c;
    h *= c * d;
    if (std::abs(c * d - 1) < 1e-15) break;
  }
  return front * h;
}

// Level of one of `cases` independent tests so that all together reject a correct sampler with probability `overall`   [Sidak67].
inline double sidak_level(double overall, int cases) { return 1 - std::pow(1 - overall, 1.0 / cases); }

// Polar coordinates about `axis`, with theta = pi t^power: a power above 1 gathers the cells around the axis, for narrow lobes.
struct SphereChart {
  Vec3f axis{0, 0, 1};
  double power = 1;

  Vec3f direction(double s, double t) const {
    const double theta = std::numbers::pi * std::pow(t, power), phi = 2 * std::numbers::pi * s;
    const auto f = [](double v) { return static_cast<float>(v); };
    return Frame(axis).to_world({f(std::sin(theta) * std::cos(phi)), f(std::sin(theta) * std::sin(phi)), f(std::cos(theta))});
  }
  // Solid angle per unit of (s, t).
  double jacobian(double t) const {
    const double pi = std::numbers::pi;
    return std::sin(pi * std::pow(t, power)) * pi * power * std::pow(t, power - 1) * 2 * pi;
  }
  std::pair<double, double> coordinates(Vec3f w) const {
    const Vec3f l = Frame(axis).to_local(w);
    const double phi = std::atan2(l.y, l.x), theta = std::atan2(std::hypot(l.x, l.y), l.z);
    return {phi / (2 * std::numbers::pi) + (phi < 0 ? 1 : 0), std::pow(theta / std::numbers::pi, 1 / power)};
  }
};

struct ChiSquareSettings {
  SphereChart chart;
  int samples = 200000;
  int cells_t = 20, cells_s = 32;
  int strips = 5;  // each cell is integrated by strips x strips squares of 3 x 3 Gauss points
  unsigned seed = 1;
};

struct ChiSquareResult {
  double p_value = 0;
  double integral = 0;          // of the density over the sphere
  double success_fraction = 0;  // of the samples
};

// `density(w)`: per steradian. Calls visit(cell, weight * density) at every quadrature point.
template <class Density>
std::vector<double> integrate_cells(const ChiSquareSettings& settings, Density density) {
  constexpr double kNode[3] = {0.5 - 0.38729833462074170, 0.5, 0.5 + 0.38729833462074170};
  constexpr double kWeight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  const int rows = settings.cells_t * settings.strips, columns = settings.cells_s * settings.strips;
  std::vector<double> cells(static_cast<std::size_t>(settings.cells_t * settings.cells_s));
  for (int row = 0; row < rows * 3; ++row) {
    const double t = (row / 3 + kNode[row % 3]) / rows;
    const double row_weight = settings.chart.jacobian(t) * kWeight[row % 3] / rows;
    for (int column = 0; column < columns * 3; ++column) {
      const double s = (column / 3 + kNode[column % 3]) / columns;
      const int cell = row / 3 / settings.strips * settings.cells_s + column / 3 / settings.strips;
      cells[static_cast<std::size_t>(cell)] += density(settings.chart.direction(s, t)) * row_weight * kWeight[column % 3] / columns;
    }
  }
  return cells;
}

// Sum of (observed - expected)^2 / expected over the pooled cells, as a p-value.
inline double pearson_p_value(std::vector<std::pair<double, double>> expected_observed) {
  std::sort(expected_observed.begin(), expected_observed.end());
  double statistic = 0, pooled_expected = 0, pooled_observed = 0;
  int cells = 0;
  for (const auto& [expected, observed] : expected_observed) {
    pooled_expected += expected;
    pooled_observed += observed;
    if (pooled_expected < 5) continue;
    statistic += (pooled_observed - pooled_expected) * (pooled_observed - pooled_expected) / pooled_expected;
    pooled_expected = pooled_observed = 0;
    ++cells;
  }
  // What is left expects next to nothing: many samples in it are a failure by themselves.
  if (pooled_observed > 30) return 0;
  return cells > 1 ? upper_incomplete_gamma((cells - 1) / 2.0, statistic / 2) : 1;
}

// `sample(u_lobe, u)`: a direction, or empty. Deterministic for a seed.
template <class Sample, class Density>
ChiSquareResult chi_square(const ChiSquareSettings& settings, Sample sample, Density density) {
  ChiSquareResult result;
  const std::vector<double> mass = integrate_cells(settings, density);
  std::vector<double> observed(mass.size());
  std::mt19937 generator(settings.seed);
  const auto uniform = [&] { return static_cast<float>(generator() >> 8) * 0x1p-24f; };
  int successes = 0;
  for (int i = 0; i < settings.samples; ++i) {
    const float u_lobe = uniform(), u_x = uniform(), u_y = uniform();
    const std::optional<Vec3f> w = sample(u_lobe, Vec2f{u_x, u_y});
    if (!w) continue;
    ++successes;
    const auto [s, t] = settings.chart.coordinates(*w);
    const int column = std::min(static_cast<int>(s * settings.cells_s), settings.cells_s - 1);
    const int row = std::min(static_cast<int>(t * settings.cells_t), settings.cells_t - 1);
    ++observed[static_cast<std::size_t>(row * settings.cells_s + column)];
  }
  std::vector<std::pair<double, double>> cells;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    result.integral += mass[i];
    cells.emplace_back(mass[i] * settings.samples, observed[i]);
  }
  cells.emplace_back(std::max(1 - result.integral, 0.0) * settings.samples, settings.samples - successes);
  result.p_value = pearson_p_value(std::move(cells));
  result.success_fraction = static_cast<double>(successes) / settings.samples;
  return result;
}

}  // namespace fluxfarm::testing
