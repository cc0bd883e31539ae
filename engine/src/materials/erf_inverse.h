// Inverse of the error function in single precision.
//
// [Giles10] M. Giles, "Approximating the erfinv Function", GPU Computing Gems 2, 2010: the single-precision pair of polynomials.
#pragma once

#include <cmath>

namespace fluxfarm {

// x in (-1, 1); relative error below 1e-6 away from the ends of the interval, where 1 - |x| itself has lost its digits.
inline float erf_inverse(float x) {
  float w = -std::log((1 - x) * (1 + x));
  float p;
  if (w < 5) {
    w -= 2.5f;
    p = 2.81022636e-08f;
    p = 3.43273939e-07f + p * w;
    p = -3.5233877e-06f + p * w;
    p = -4.39150654e-06f + p * w;
    p = 0.00021858087f + p * w;
    p = -0.00125372503f + p * w;
    p = -0.00417768164f + p * w;
    p = 0.246640727f + p * w;
    p = 1.50140941f + p * w;
  } else {
    w = std::sqrt(w) - 3;
    p = -0.000200214257f;
    p = 0.000100950558f + p * w;
    p = 0.00134934322f + p * w;
    p = -0.00367342844f + p * w;
    p = 0.00573950773f + p * w;
    p = -0.0076224613f + p * w;
    p = 0.00943887047f + p * w;
    p = 1.00167406f + p * w;
    p = 2.83297682f + p * w;
  }
  return p * x;
}

}  // namespace fluxfarm
