#include "emitters/lat_long_image.h"

#include <algorithm>
#include <cmath>

namespace fluxfarm {

namespace {

// Rounding may reach the end of the last cell. What is no number stays inside, too, and shows in the place within the cell.
int index(float coordinate, int cells) { return coordinate > 0 ? std::min(static_cast<int>(coordinate), cells - 1) : 0; }

}  // namespace

LatLongImage::Cell LatLongImage::cell(Vec3f d) const {
  // Both angles by arc tangents: the arc cosine has few digits near the poles.
  const float turn = std::atan2(d.x, -d.z) / kTwoPi;  // [-1/2, 1/2]
  const float half_turn = std::atan2(std::sqrt(d.x * d.x + d.z * d.z), d.y) * kInvPi;
  float x = turn * static_cast<float>(width) - 0.5f;
  if (x < 0) x += static_cast<float>(width);
  const float y = half_turn * static_cast<float>(height - 1);
  const int column = index(x, width), row = index(y, height - 1);
  return {column, row, x - static_cast<float>(column), y - static_cast<float>(row)};
}

Vec3f LatLongImage::direction(int column, float x, double cos_theta) const {
  const float azimuth = kTwoPi * (static_cast<float>(column) + 0.5f + x) / static_cast<float>(width);
  const auto sin_theta = static_cast<float>(std::sqrt(std::max((1 - cos_theta) * (1 + cos_theta), 0.0)));
  return {std::sin(azimuth) * sin_theta, static_cast<float>(cos_theta), -std::cos(azimuth) * sin_theta};
}

Rgb LatLongImage::radiance(const Cell& cell) const {
  const auto [column, row, x, y] = cell;
  const Rgb upper = pixel(column, row) * (1 - x) + pixel(next(column), row) * x;
  const Rgb lower = pixel(column, row + 1) * (1 - x) + pixel(next(column), row + 1) * x;
  return upper * (1 - y) + lower * y;
}

Rgb LatLongImage::mean(int column, int row) const {
  const int other = next(column);
  return 0.25f * (pixel(column, row) + pixel(other, row) + pixel(column, row + 1) + pixel(other, row + 1));
}

}  // namespace fluxfarm
