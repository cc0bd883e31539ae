#include "split_sphere.h"

#include <algorithm>
#include <cmath>

#include "sampling/warp.h"

namespace fluxfarm::ablation {

PlaneGradient cell_gradient(std::span<const GatheredLight> lights) {
  const auto n = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(lights.size()))));
  const auto corner = [n](std::size_t x, std::size_t y) {
    return square_to_cosine_hemisphere(
        {static_cast<float>(x) / static_cast<float>(n), static_cast<float>(y) / static_cast<float>(n)});
  };
  PlaneGradient sum;
  // The edge from p to q between two cells: `across`, as long as the edge, is at right angles to it and leads from the one to the
  // other.
  const auto add = [&](const GatheredLight& from, const GatheredLight& to, Vec3f p, Vec3f q) {
    Vec3f across = cross(p, q);
    if (dot(across, to.direction - from.direction) < 0) across = -across;
    const float cosine = (p.z + q.z) / 2;
    const float change = (luminance(to.radiance) - luminance(from.radiance)) * cosine / std::min(from.distance, to.distance);
    sum.x += change * across.x;
    sum.y += change * across.y;
  };
  for (std::size_t y = 0; y < n; ++y) {
    for (std::size_t x = 0; x < n; ++x) {
      const GatheredLight& light = lights[y * n + x];
      if (x > 0) add(lights[y * n + x - 1], light, corner(x, y), corner(x, y + 1));
      if (y > 0) add(lights[(y - 1) * n + x], light, corner(x, y), corner(x + 1, y));
    }
  }
  return sum;
}

}  // namespace fluxfarm::ablation
