// What a split-sphere cache takes from a hemisphere of strata: the harmonic mean distance and the gradient of stratified cells.
//
// [Ward88] G. Ward, F. Rubinstein, R. Clear, "A Ray Tracing Solution for Diffuse Interreflection", SIGGRAPH 1988.
// [WardHeckbert92] G. Ward, P. Heckbert, "Irradiance Gradients", EGWR 1992. There cells are bounded by angles, here by the square
// grid that the engine bends over the hemisphere; what moves at an edge between two cells is the same.
#pragma once

#include <span>

#include "integrators/irradiance/hemisphere_grid.h"

namespace fluxfarm::ablation {

// Of the surfaces around a place, by cosine-weighted strata, m; infinite where there are none. [Ward88]
inline float harmonic_mean_distance(std::span<const GatheredLight> lights) {
  double closeness = 0;
  for (const GatheredLight& light : lights) closeness += 1 / static_cast<double>(light.distance);
  return static_cast<float>(static_cast<double>(lights.size()) / closeness);
}

// Of the irradiance's luminance over the place in the tangent plane, W m^-3.
struct PlaneGradient {
  float x = 0, y = 0;
};

// Each cell is a patch of even radiance. As the place moves, the edge between two of them moves as what is nearer does.
PlaneGradient cell_gradient(std::span<const GatheredLight> lights);

}  // namespace fluxfarm::ablation
