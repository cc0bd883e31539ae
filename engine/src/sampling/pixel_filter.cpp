#include "sampling/pixel_filter.h"

#include <algorithm>
#include <cmath>

namespace fluxfarm {
namespace {

constexpr int kSteps = 4096;

// Offsets at which the cumulative integral of the cut Gaussian reaches i / kSteps. The filter is lowered so that it meets zero at
// the cut, as is usual for image filters.
std::vector<float> invert_gaussian(double stddev, double radius) {
  const auto density = [&](double x) {
    const auto gauss = [&](double t) { return std::exp(-t * t / (2 * stddev * stddev)); };
    return std::max(0.0, gauss(x) - gauss(radius));
  };
  constexpr int kFine = 1 << 16;
  const double h = 2 * radius / kFine;
  std::vector<double> cumulative(kFine + 1, 0.0);
  for (int i = 0; i < kFine; ++i) cumulative[i + 1] = cumulative[i] + density(-radius + (i + 0.5) * h) * h;
  std::vector<float> inverse(kSteps + 1);
  int cell = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double target = cumulative[kFine] * i / kSteps;
    while (cell < kFine - 1 && cumulative[cell + 1] < target) ++cell;
    const double width = cumulative[cell + 1] - cumulative[cell];
    const double part = width > 0 ? (target - cumulative[cell]) / width : 0.0;
    inverse[i] = static_cast<float>(-radius + (cell + std::min(part, 1.0)) * h);
  }
  return inverse;
}

}  // namespace

PixelFilter::PixelFilter(const PixelFilterDescription& description) : kind_(description.kind), radius_(description.radius) {
  if (kind_ == PixelFilterKind::kGaussian) {
    radius_ = 4 * description.stddev;
    inverse_cdf_ = invert_gaussian(static_cast<double>(description.stddev), static_cast<double>(radius_));
  } else if (radius_ == 0) {
    radius_ = kind_ == PixelFilterKind::kBox ? 0.5f : 1.0f;
  }
}

float PixelFilter::sample_axis(float u) const {
  switch (kind_) {
    case PixelFilterKind::kBox: return radius_ * (2 * u - 1);
    case PixelFilterKind::kTent:  // inverse of the two parabolas of the integrated tent
      return std::copysign(radius_ * (1 - std::sqrt(2 * std::min(u, 1 - u))), u - 0.5f);
    case PixelFilterKind::kGaussian: {
      const float position = u * kSteps;
      const int cell = static_cast<int>(position);
      const float part = position - static_cast<float>(cell);
      return inverse_cdf_[cell] + part * (inverse_cdf_[cell + 1] - inverse_cdf_[cell]);
    }
  }
  return 0;
}

}  // namespace fluxfarm
