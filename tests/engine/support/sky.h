// Skies for tests of the environment map, and what falls from them, by quadrature.
#pragma once

#include <cmath>
#include <random>

#include "emitters/lat_long_image.h"

namespace fluxfarm::testing {

// Grey pixels in [0, 1), a quarter of them black.
inline LatLongImage patchy_sky(int width, int height) {
  LatLongImage sky{width, height, {}};
  std::mt19937 generator(7);
  for (int i = 0; i < width * height; ++i) {
    const float value = static_cast<float>(generator() >> 8) * 0x1p-24f;
    sky.pixels.emplace_back(generator() % 4 == 0 ? 0.0f : value);
  }
  return sky;
}

inline LatLongImage even_sky(float radiance) { return {8, 5, std::vector<Rgb>(40, Rgb{radiance})}; }

// A dim sky with a sun of one pixel, a few degrees wide, 60 degrees above the horizon.
inline LatLongImage sunny_sky() {
  LatLongImage sky{128, 67, std::vector<Rgb>(128 * 67, Rgb{0.5f})};
  sky.pixels[128 * 11 + 40] = Rgb{50000.0f};
  return sky;
}

// Irradiance on a plane whose normal is `up`: the integral of radiance times the cosine over the hemisphere, W m^-2, where
// `radiance(direction)` is the green channel of what arrives. Without `sine` it is what a renderer finds that takes equal steps of
// the polar angle for equal solid angles.
template <class Radiance>
double irradiance(Radiance radiance, Vec3f up, bool sine = true) {
  constexpr int kRows = 1200, kColumns = 2400;
  const double step_theta = M_PI / kRows, step_phi = 2 * M_PI / kColumns;
  double sum = 0;
  for (int row = 0; row < kRows; ++row) {
    const double theta = (row + 0.5) * step_theta;
    const double measure = (sine ? std::sin(theta) : 1) * step_theta * step_phi;
    for (int column = 0; column < kColumns; ++column) {
      const double phi = (column + 0.5) * step_phi;
      const Vec3f direction{static_cast<float>(std::sin(theta) * std::cos(phi)), static_cast<float>(std::cos(theta)),
                            static_cast<float>(std::sin(theta) * std::sin(phi))};
      const float cosine = dot(direction, up);
      if (cosine > 0) sum += static_cast<double>(radiance(direction) * cosine) * measure;
    }
  }
  return sum;
}

}  // namespace fluxfarm::testing
