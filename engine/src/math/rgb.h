// Linear Rec.709 RGB triple: a radiance (W m^-2 sr^-1), a reflectance, or a path's throughput; the context says which.
#pragma once

#include <algorithm>
#include <cmath>

namespace fluxfarm {

struct Rgb {
  float r = 0, g = 0, b = 0;

  constexpr Rgb() = default;
  constexpr explicit Rgb(float grey) : r(grey), g(grey), b(grey) {}
  constexpr Rgb(float red, float green, float blue) : r(red), g(green), b(blue) {}

  constexpr Rgb& operator+=(Rgb o) { return *this = {r + o.r, g + o.g, b + o.b}; }
  constexpr Rgb& operator*=(Rgb o) { return *this = {r * o.r, g * o.g, b * o.b}; }
  constexpr Rgb& operator*=(float s) { return *this = {r * s, g * s, b * s}; }
  constexpr bool operator==(const Rgb&) const = default;
  constexpr bool is_black() const { return r == 0 && g == 0 && b == 0; }
};

constexpr Rgb operator+(Rgb a, Rgb b) { return {a.r + b.r, a.g + b.g, a.b + b.b}; }
constexpr Rgb operator-(Rgb a, Rgb b) { return {a.r - b.r, a.g - b.g, a.b - b.b}; }
constexpr Rgb operator*(Rgb a, Rgb b) { return {a.r * b.r, a.g * b.g, a.b * b.b}; }
constexpr Rgb operator*(Rgb a, float s) { return {a.r * s, a.g * s, a.b * s}; }
constexpr Rgb operator*(float s, Rgb a) { return a * s; }
constexpr Rgb operator/(Rgb a, Rgb b) { return {a.r / b.r, a.g / b.g, a.b / b.b}; }
constexpr Rgb operator/(Rgb a, float s) { return a * (1 / s); }

// Rec.709 luminance (ITU-R BT.709-6, item 3.2).
constexpr float luminance(Rgb c) { return 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b; }
constexpr float max_component(Rgb c) { return std::max(c.r, std::max(c.g, c.b)); }
constexpr float mean(Rgb c) { return (c.r + c.g + c.b) * (1.0f / 3.0f); }
inline bool is_finite(Rgb c) { return std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b); }

}  // namespace fluxfarm
