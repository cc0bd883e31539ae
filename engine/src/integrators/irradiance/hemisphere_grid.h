// What a place receives, direction by direction: a square grid of strata, bent over its hemisphere by the concentric map, so that
// each holds an equal part of the cosine-weighted light and neighbours in the grid are neighbours in the sky.
//
// [WardHeckbert92] G. Ward, P. Heckbert, "Irradiance Gradients", EGWR 1992.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "integrators/irradiance/edge_irradiance.h"
#include "math/rgb.h"
#include "math/vec.h"
#include "sampling/sampler.h"

namespace fluxfarm {

struct GatheredLight {
  Vec3f direction;     // in the frame of the place, z along its normal, unit
  float distance = 0;  // to the surface there, m; infinite where there is none
  Rgb radiance;        // from there, W m^-2 sr^-1
};

// All that a record of irradiance is made of.
struct HemisphereIrradiance {
  Rgb irradiance;                             // W m^-2
  std::array<Rgb, kReplicates> by_replicate;  // the same by the strata of each replicate alone
  // The tangential part of the integral of radiance times direction, W m^-2: irradiance on a plane that is turned a little is its
  // scalar product with that plane's normal, but for light near the horizon. It is the rotational gradient [WardHeckbert92].
  Rgb turned_x, turned_y;
  // Over the place in the tangent plane, W m^-3: as much of it as is likely to be more than noise.
  Rgb gradient_x, gradient_y;
  float gradient_noise = 0;  // standard deviation along an axis, of the luminance
  TangentMatrix hessian;     // of the luminance, W m^-4
  // An ellipse of the tangent plane, d^T clearance d < 1, m^-2: the space around it has none of the surfaces that were seen. Long
  // where they leave room, as beside a wall.
  TangentMatrix clearance;
  Vec3f nearest;  // of their points that were seen, from the place, in its frame, m
  // What neighbours have shown to be wrong: a matrix whose product with a place, to the power 3/2, is the error there, W m^-2.
  TangentMatrix misfit;
  float near_irradiance = 0;  // luminance that what is near would make if it were all around, W m^-2

  // Standard deviation of the irradiance's luminance by that of its replicates, W m^-2.
  float noise() const;
};

class HemisphereGrid {
 public:
  // `strata`: along a side; a multiple of kReplicates. What is infinitely far counts as `far` (m) where things move past each
  // other.
  HemisphereGrid(int strata, float far) : strata_(strata), far_(far), lights_(static_cast<std::size_t>(strata) * strata) {}

  std::size_t size() const { return lights_.size(); }
  // Stratum `index` by rows: where it lies in the unit square, u in [0,1)^2 moves in it.
  Vec2f place(std::size_t index, Vec2f u) const {
    const auto n = static_cast<std::size_t>(strata_);
    const std::size_t column = index % n, row = index / n;
    return {(static_cast<float>(column) + u.x) / static_cast<float>(n), (static_cast<float>(row) + u.y) / static_cast<float>(n)};
  }
  // Each replicate has one stratum in any kReplicates of a row, three columns on in the next row.
  std::uint32_t replicate(std::size_t index) const {
    const auto n = static_cast<std::size_t>(strata_);
    return static_cast<std::uint32_t>((index % n + 3 * (index / n)) % kReplicates);
  }
  GatheredLight& light(std::size_t index) { return lights_[index]; }

  HemisphereIrradiance irradiance() const;

 private:
  void add_triangles(HemisphereIrradiance& sum) const;
  // How much a light says of what is near, at `least_distance` (m).
  double nearness(const GatheredLight& light, float least_distance) const;
  TangentMatrix clearance(float least_distance) const;

  int strata_;
  float far_;  // m
  std::vector<GatheredLight> lights_;
};

}  // namespace fluxfarm
