// When a goal of relative error may be called reached: an upper bound of the true error that holds with 95 % over all looks.
//
// The k-th look (k = 1, 2, ...) may be wrong with probability 0.05 / 2^k, so that all of them together are wrong with at most
// 0.05, however long the job runs.
//
// The true relMSE Q and its estimate V, both means over pixels, have the same expectation. With Gaussian replicates Q is nearly a
// chi-square variable with n degrees of freedom over n, where n = (sum of s^2)^2 / (sum of s^4) counts the pixels that carry the
// error, and V one with (R - 1) n: the bound is V times a quantile of the F distribution. A pixel's channels are taken as fully
// correlated. s^2 is pooled over cells of neighbouring pixels: a single bright sample belongs to a rare event that could have
// struck any of them, and in the pixel that it did strike Q and V rise together.
#pragma once

namespace fluxfarm {

class ErrorBound {
 public:
  // A cell: the sum over its pixels of the mean over channels of Var(I) / (R^2 + 1e-2), where R is an estimate of the true value.
  void add(double relative_variance, int pixels) {
    sum_ += relative_variance;
    squares_ += relative_variance * relative_variance / pixels;
    pixels_ += pixels;
  }
  // All cells of another part of the picture.
  void add(const ErrorBound& part) {
    sum_ += part.sum_;
    squares_ += part.squares_;
    pixels_ += part.pixels_;
  }
  // As if more samples had left that much of each cell's variance.
  void scale(double left) {
    sum_ *= left;
    squares_ *= left * left;
  }

  // After at least one cell: the estimate of relMSE, and the upper bound of sqrt(relMSE) at look `number` (1, 2, ...).
  double estimate() const { return sum_ / pixels_; }
  double at(int number) const;
  double pixels() const { return pixels_; }
  double squares() const { return squares_; }  // sum over the cells of relative_variance^2 / pixels

 private:
  double sum_ = 0, squares_ = 0, pixels_ = 0;
};

// z such that a standard Gaussian exceeds it with probability p, 0 < p <= 0.5.
double gaussian_upper_quantile(double p);

// What the F distribution with n and m degrees of freedom exceeds with the probability with which a Gaussian exceeds z; infinite
// where the approximation ends (few degrees of freedom, large z).                                           [Paulson42]
double f_upper_quantile(double n, double m, double z);

}  // namespace fluxfarm
