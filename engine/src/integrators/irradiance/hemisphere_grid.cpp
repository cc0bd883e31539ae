#include "integrators/irradiance/hemisphere_grid.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fluxfarm {
namespace {

// Where directions are flatter, light counts as if it came so steep (a choice): their part in a turn of the surface has no bound.
constexpr float kLeastCosine = 0.1f;

struct Corner {
  Vec3f place;  // from the receiver, m
  float distance;
  double gradient_x = 0, gradient_y = 0;  // that its radiance makes, over it
};

// What a triangle between three strata adds to the derivatives, over its radiance.
struct Triangle {
  double gradient_x = 0, gradient_y = 0;
  TangentMatrix hessian;

  void add(const EdgeIrradiance& edge, double sign) {
    gradient_x += sign * edge.gradient_x;
    gradient_y += sign * edge.gradient_y;
    hessian.xx += sign * edge.hessian.xx;
    hessian.xy += sign * edge.hessian.xy;
    hessian.yy += sign * edge.hessian.yy;
  }
};

// Parts of the corners' radiances in that of their triangle: it is that of what lies farthest, where something stands before it;
// else their mean.
std::array<float, 3> parts(const std::array<float, 3>& distances) {
  constexpr float kSameSurface = 0.7f;  // nearest over farthest (a choice)
  const auto [nearest, farthest] = std::minmax_element(distances.begin(), distances.end());
  if (*nearest > kSameSurface * *farthest) return {1.0f / 3, 1.0f / 3, 1.0f / 3};
  std::array<float, 3> parts{};
  parts[static_cast<std::size_t>(farthest - distances.begin())] = 1;
  return parts;
}

}  // namespace

float HemisphereIrradiance::noise() const {
  float squares = 0;
  for (const Rgb& replicate : by_replicate) {
    const float difference = luminance(replicate) - luminance(irradiance);
    squares += difference * difference;
  }
  return std::sqrt(squares / (kReplicates * (kReplicates - 1)));
}

HemisphereIrradiance HemisphereGrid::irradiance() const {
  HemisphereIrradiance sum;
  float least_distance = far_;
  sum.nearest = {0, 0, far_};
  for (std::size_t i = 0; i < lights_.size(); ++i) {
    const GatheredLight& light = lights_[i];
    sum.by_replicate[replicate(i)] += light.radiance;
    const float per_cosine = 1 / std::max(light.direction.z, kLeastCosine);
    sum.turned_x += light.radiance * (light.direction.x * per_cosine);
    sum.turned_y += light.radiance * (light.direction.y * per_cosine);
    if (light.distance < least_distance) {
      least_distance = light.distance;
      sum.nearest = light.direction * light.distance;
    }
  }
  const float weight = kPi / static_cast<float>(lights_.size());
  for (Rgb& replicate : sum.by_replicate) {
    sum.irradiance += replicate * weight;
    replicate *= weight * static_cast<float>(kReplicates);
  }
  sum.turned_x *= weight;
  sum.turned_y *= weight;
  double bright = 0, weights = 0;
  for (const GatheredLight& light : lights_) {
    const double near = nearness(light, least_distance);
    bright += near * static_cast<double>(luminance(light.radiance));
    weights += near;
  }
  sum.near_irradiance = static_cast<float>(M_PI * bright / weights);
  add_triangles(sum);
  sum.clearance = clearance(least_distance);
  return sum;
}

double HemisphereGrid::nearness(const GatheredLight& light, float least_distance) const {
  const auto closeness = static_cast<double>(least_distance / std::min(light.distance, far_));
  return closeness * closeness * closeness * closeness;
}

// The short axis points to where what is near lies; what lies to the sides bounds the long one.
TangentMatrix HemisphereGrid::clearance(float least_distance) const {
  constexpr double kSeen = 0.8;  // the nearest point of a surface over the nearest one that was seen, at least (a choice)
  const double across = kSeen * static_cast<double>(least_distance);
  TangentMatrix near;
  for (const GatheredLight& light : lights_) {
    const double weight = nearness(light, least_distance);
    const auto x = static_cast<double>(light.direction.x), y = static_cast<double>(light.direction.y);
    near.xx += weight * x * x;
    near.xy += weight * x * y;
    near.yy += weight * y * y;
  }
  const double angle = 0.5 * std::atan2(2 * near.xy, near.xx - near.yy), ux = std::cos(angle), uy = std::sin(angle);
  double along = static_cast<double>(far_);
  for (const GatheredLight& light : lights_) {
    const auto distance = static_cast<double>(std::min(light.distance, far_));
    const double x = distance * static_cast<double>(light.direction.x), y = distance * static_cast<double>(light.direction.y),
                 z = distance * static_cast<double>(light.direction.z);
    const double s = x * ux + y * uy, l = x * uy - y * ux, across_squared = s * s + z * z;
    if (across_squared < across * across) along = std::min(along, std::fabs(l) / std::sqrt(1 - across_squared / (across * across)));
  }
  const double first = 1 / (across * across), second = 1 / (along * along);
  return {first * ux * ux + second * uy * uy, (first - second) * ux * uy, first * uy * uy + second * ux * ux};
}

// The light between strata: each cell of four is two triangles, and what an edge adds to the one on its left it takes from the one
// on its right. Beyond the outermost strata the light is taken to go on as it is there, down to the horizon.
void HemisphereGrid::add_triangles(HemisphereIrradiance& sum) const {
  const auto n = static_cast<std::size_t>(strata_);
  std::vector<Corner> corners(lights_.size());
  for (std::size_t i = 0; i < lights_.size(); ++i) {
    corners[i].distance = std::min(lights_[i].distance, far_);
    corners[i].place = lights_[i].direction * corners[i].distance;
  }
  // Of cell (x, y): the triangle below its diagonal from (x, y) to (x + 1, y + 1), and the one above.
  const std::size_t cells = n - 1;
  std::vector<Triangle> below(cells * cells), above(cells * cells);
  const auto add = [&](std::size_t first, std::size_t second, Triangle& left, Triangle& right) {
    const EdgeIrradiance edge = edge_irradiance(corners[first].place, corners[second].place);
    left.add(edge, 1);
    right.add(edge, -1);
  };
  for (std::size_t y = 0; y < cells; ++y) {
    for (std::size_t x = 0; x < cells; ++x) {
      const std::size_t corner = y * n + x, cell = y * cells + x;
      add(corner, corner + n + 1, above[cell], below[cell]);
      if (y > 0) add(corner, corner + 1, below[cell], above[cell - cells]);
      if (x > 0) add(corner, corner + n, below[cell - 1], above[cell]);
    }
  }
  // So the outermost triangles have a part of the horizon for an edge. It moves as the place does: it is what is below their outer
  // edges, upright, so that the sides of what hangs there add nothing.
  const auto end_at_horizon = [&](std::size_t first, std::size_t second, Triangle& triangle) {
    const Vec3f a = corners[first].place, b = corners[second].place;
    triangle.add(edge_irradiance({a.x, a.y, 0}, {b.x, b.y, 0}), 1);
  };
  for (std::size_t i = 0; i < cells; ++i) {
    const std::size_t top = cells * n + i, left = i * n, last = (cells - 1) * cells;
    end_at_horizon(i, i + 1, below[i]);
    end_at_horizon(left + cells, left + cells + n, below[i * cells + cells - 1]);
    end_at_horizon(top + 1, top, above[last + i]);
    end_at_horizon(left + n, left, above[i * cells]);
  }
  const auto shine = [&](const Triangle& triangle, const std::array<std::size_t, 3>& at) {
    const std::array<float, 3> part = parts({corners[at[0]].distance, corners[at[1]].distance, corners[at[2]].distance});
    Rgb radiance;
    for (std::size_t i = 0; i < 3; ++i) {
      radiance += lights_[at[i]].radiance * part[i];
      corners[at[i]].gradient_x += triangle.gradient_x * static_cast<double>(part[i]);
      corners[at[i]].gradient_y += triangle.gradient_y * static_cast<double>(part[i]);
    }
    sum.gradient_x += radiance * static_cast<float>(triangle.gradient_x);
    sum.gradient_y += radiance * static_cast<float>(triangle.gradient_y);
    const auto brightness = static_cast<double>(luminance(radiance));
    sum.hessian.xx += brightness * triangle.hessian.xx;
    sum.hessian.xy += brightness * triangle.hessian.xy;
    sum.hessian.yy += brightness * triangle.hessian.yy;
  };
  for (std::size_t y = 0; y < cells; ++y) {
    for (std::size_t x = 0; x < cells; ++x) {
      const std::size_t corner = y * n + x, cell = y * cells + x;
      shine(below[cell], {corner, corner + 1, corner + n + 1});
      shine(above[cell], {corner, corner + n + 1, corner + n});
    }
  }
  // The noise of each stratum is its difference from its neighbours.
  double variance = 0;
  for (std::size_t y = 0; y < n; ++y) {
    for (std::size_t x = 0; x < n; ++x) {
      const std::size_t i = y * n + x;
      float around = 0;
      int neighbours = 0;
      const auto look = [&](std::size_t j) {
        around += luminance(lights_[j].radiance);
        ++neighbours;
      };
      if (x > 0) look(i - 1);
      if (x + 1 < n) look(i + 1);
      if (y > 0) look(i - n);
      if (y + 1 < n) look(i + n);
      const auto difference = static_cast<double>(luminance(lights_[i].radiance) - around / static_cast<float>(neighbours));
      variance += difference * difference * neighbours / (neighbours + 1) *
                  (corners[i].gradient_x * corners[i].gradient_x + corners[i].gradient_y * corners[i].gradient_y);
    }
  }
  // What the noise leaves of a gradient.
  const auto steep = [](Rgb gradient) {
    return static_cast<double>(luminance(gradient)) * static_cast<double>(luminance(gradient));
  };
  const double squared = steep(sum.gradient_x) + steep(sum.gradient_y);
  const double signal = squared > 0 ? std::max(1 - variance / squared, 0.0) : 0.0;
  sum.gradient_x *= static_cast<float>(signal);
  sum.gradient_y *= static_cast<float>(signal);
  sum.gradient_noise = static_cast<float>(std::sqrt(variance / 2));
}

}  // namespace fluxfarm
