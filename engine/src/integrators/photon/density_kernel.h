// How much a photon counts by its distance from the place that asks.
//
// weight(t), t = (distance / radius)^2 in [0,1], has mean one over the disk, so that the sum of weight x flux over the area of the
// disk is right where the light is even, whatever the kernel. Where it is not, the estimate is off by kBias radius^2 times the
// Laplacian of the irradiance; its variance is kVariance times that of the box. sample(u), where there is one, is the t of a point
// of the disk with density weight(t) / area, for u even in [0,1).
#pragma once

#include <cmath>

namespace fluxfarm {

// How large the bias of an estimate is, over its difference from that in half the area. A bias that goes with the radius, as at
// edges of surfaces and shadows, is sqrt(1/2) as large there; one that goes with its square, as where light changes smoothly, is
// half as large, and is thought to be 1.7 times what it is.
inline constexpr float kBiasPerDifference = 1 / (1 - 0.70710678f);

struct BoxKernel {
  static constexpr double kBias = 1.0 / 8, kVariance = 1;
  float weight(float) const { return 1; }
  float sample(float u) const { return u; }
};

// Of all kernels the one with the least mean squared error at its best radius.                              [Epanechnikov69]
// [Epanechnikov69] V. A. Epanechnikov, "Non-Parametric Estimation of a Multivariate Probability Density", Theory Probab. Appl. 14,
// 1969.
struct EpanechnikovKernel {
  static constexpr double kBias = 1.0 / 12, kVariance = 4.0 / 3;
  float weight(float t) const { return 2 * (1 - t); }
  float sample(float u) const { return 1 - std::sqrt(1 - u); }
};

// Smooth at its rim, too.                                                                          [Silverman86]
// [Silverman86] B. W. Silverman, "Density Estimation for Statistics and Data Analysis", Chapman and Hall 1986.
struct SilvermanKernel {
  static constexpr double kBias = 1.0 / 16, kVariance = 9.0 / 5;
  float weight(float t) const { return 3 * (1 - t) * (1 - t); }
};

// Jensen's cone filter 1 - d / (k r), k >= 1, over its mean 1 - 2 / (3 k).                                         [Jensen96]
class ConeKernel {
 public:
  explicit ConeKernel(float k = 1) : slope_(1 / k), scale_(1 / (1 - 2 / (3 * k))) {}
  float weight(float t) const { return (1 - std::sqrt(t) * slope_) * scale_; }

 private:
  float slope_, scale_;
};

}  // namespace fluxfarm
