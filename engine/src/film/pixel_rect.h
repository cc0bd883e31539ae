// Half-open rectangle of pixels and half-open range of sample indices.
#pragma once

#include <cstdint>

namespace fluxfarm {

// Pixels x <= px < x + width, y <= py < y + height; origin top left of the full frame.
struct PixelRect {
  int x = 0, y = 0, width = 0, height = 0;

  constexpr int pixels() const { return width * height; }
  constexpr bool empty() const { return width <= 0 || height <= 0; }
  constexpr bool contains(const PixelRect& o) const {
    return o.x >= x && o.y >= y && o.x + o.width <= x + width && o.y + o.height <= y + height;
  }
  constexpr bool operator==(const PixelRect&) const = default;
};

// Sample indices begin <= i < end of every pixel of a rect.
struct SampleRange {
  std::uint32_t begin = 0, end = 0;

  constexpr std::uint32_t size() const { return end - begin; }
  constexpr bool operator==(const SampleRange&) const = default;
};

}  // namespace fluxfarm
