// Three non-negative numbers in 32 bits: 8 bits each and a common exponent.                                          [Ward91]
//
// [Ward91] G. Ward, "Real Pixels", Graphics Gems II, 1991. What differs: rounding is dithered, so that a sum of many has no bias.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "math/rgb.h"

namespace fluxfarm {

// For a `dither` that is even in [0,1) the mean of what is read back is `c`; each channel is off by less than 1/127 of the largest.
// From 2^-100 to 2^127; what is smaller becomes black.
inline std::uint32_t to_rgbe(Rgb c, float dither) {
  const float largest = max_component(c);
  if (!(largest > 0x1p-100f)) return 0;
  int exponent;
  float mantissa = std::frexp(largest, &exponent) * 256;  // in [128, 256)
  if (mantissa > 255) ++exponent;                         // so that no dither lifts it to 256
  const float scale = std::ldexp(256.0f, -exponent);
  const auto bits = [&](float value) { return static_cast<std::uint32_t>(std::max(value, 0.0f) * scale + dither); };
  return bits(c.r) << 24 | bits(c.g) << 16 | bits(c.b) << 8 | static_cast<std::uint32_t>(exponent + 127);
}

inline Rgb from_rgbe(std::uint32_t bits) {
  const std::uint32_t exponent = bits & 0xff;
  const float scale = std::bit_cast<float>((std::max(exponent, 8u) - 8) << 23);
  const auto channel = [&](int shift) { return static_cast<float>(static_cast<std::int32_t>(bits >> shift & 0xff)) * scale; };
  return {channel(24), channel(16), channel(8)};
}

}  // namespace fluxfarm
