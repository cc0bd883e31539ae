// When a goal of relative error may be called reached: an upper bound of the true error that holds with 95 % over all looks.
//
// A look is taken whenever the samples per pixel have doubled: at 16, 32, 64, ... The k-th look (k = 1, 2, ...) may be wrong with
// probability 0.05 / 2^k, so that all of them together are wrong with at most 0.05, however long the job runs.
//
// The true relMSE Q and its estimate V, both means over pixels, have the same expectation. With Gaussian replicates Q is nearly a
// chi-square variable with n degrees of freedom over n, where n = (sum of s^2)^2 / (sum of s^4) counts the pixels that carry the
// error, and V one with (R - 1) n: the bound is V times a quantile of the F distribution. A pixel's channels are taken as fully
// correlated. One bright pixel that carries most of the error makes n small and the bound wide.
#pragma once

#include <cstdint>

namespace fluxfarm {

// Whether a decision is due at so many samples per pixel.
bool is_look(std::uint32_t samples);

class ErrorBound {
 public:
  // One pixel: the mean over channels of Var(I) / (R^2 + 1e-2), where R is an estimate of the true value.
  void add(double relative_variance) {
    sum_ += relative_variance;
    squares_ += relative_variance * relative_variance;
    ++pixels_;
  }

  // Upper bound of sqrt(relMSE) after at least one pixel; is_look(samples).
  double at(std::uint32_t samples) const;

 private:
  double sum_ = 0, squares_ = 0;
  std::uint64_t pixels_ = 0;
};

// z such that a standard Gaussian exceeds it with probability p, 0 < p <= 0.5.
double gaussian_upper_quantile(double p);

// What the F distribution with n and m degrees of freedom exceeds with the probability with which a Gaussian exceeds z; infinite
// where the approximation ends (few degrees of freedom, large z).                                           [Paulson42]
double f_upper_quantile(double n, double m, double z);

}  // namespace fluxfarm
