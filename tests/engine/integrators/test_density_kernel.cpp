// Kernels of density estimates by numerical integration over the disk: catalogue P4 and P5.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "integrators/photon/density_kernel.h"

namespace fluxfarm {
namespace {

// Mean of weight(t) g(t) over the disk, t = (d / r)^2.
double mean_over_disk(const std::function<double(double)>& value) {
  constexpr int kSteps = 100000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) sum += value((i + 0.5) / kSteps) / kSteps;  // t is even over the disk
  return sum;
}

template <typename Kernel>
void expect_constants(const char* name, Kernel kernel) {
  const auto weight = [&](double t) { return static_cast<double>(kernel.weight(static_cast<float>(t))); };
  EXPECT_NEAR(mean_over_disk(weight), 1, 1e-5) << name;
  // E + (x^2 E_xx + z^2 E_zz) / 2: the mean of x^2 is that of t / 2.
  EXPECT_NEAR(mean_over_disk([&](double t) { return weight(t) * t / 4; }), Kernel::kBias, 1e-5) << name;
  EXPECT_NEAR(mean_over_disk([&](double t) { return weight(t) * weight(t); }), Kernel::kVariance, 1e-4) << name;
}

TEST(DensityKernel, P4_WeightsHaveMeanOneAndTheStatedConstants) {
  expect_constants("box", BoxKernel{});
  expect_constants("Epanechnikov", EpanechnikovKernel{});
  expect_constants("Silverman", SilvermanKernel{});
}

TEST(DensityKernel, P4_JensensGaussianWouldBeNearlyHalfTooDark) {
  const auto gaussian = [](double alpha) {
    return mean_over_disk([&](double t) { return alpha * (1 - (1 - std::exp(-1.953 * t / 2)) / (1 - std::exp(-1.953))); });
  };
  EXPECT_NEAR(gaussian(0.918), 0.531155, 1e-5);
  EXPECT_NEAR(gaussian(1.728309), 1, 1e-5);
}

TEST(DensityKernel, P5_TheConeIsRightForAnySlope) {
  for (const double k : {1.0, 1.1, 2.0, 5.0}) {
    const ConeKernel cone(static_cast<float>(k));
    EXPECT_NEAR(mean_over_disk([&](double t) { return static_cast<double>(cone.weight(static_cast<float>(t))); }), 1, 1e-5) << k;
    const double without_area = mean_over_disk([&](double t) { return 1 - std::sqrt(t) / k; });
    EXPECT_NEAR(without_area, 1 - 2 / (3 * k), 1e-5) << k;
  }
}

}  // namespace
}  // namespace fluxfarm
