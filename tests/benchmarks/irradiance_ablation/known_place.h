// All that any of the compared methods may know of a place, gathered once: caches of all methods and sizes take their records from
// these.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometric_hessian.h"
#include "integrators/irradiance/hemisphere_sampler.h"
#include "scene/scene.h"
#include "split_sphere.h"

namespace fluxfarm::ablation {

// Luminances; in the frame of the place.
struct KnownPlace {
  GatherPlace place;
  float pixel_m = 0;                 // side of what a pixel sees there
  float irradiance = 0;              // W m^-2
  std::array<float, 2> by_half{};    // by half of the strata each
  float turned_x = 0, turned_y = 0;  // as in HemisphereIrradiance
  PlaneGradient cell_gradient, occlusion_gradient;
  TangentMatrix occlusion_hessian;  // W m^-4
  GeometricHessian geometric_hessian;
  float harmonic_mean_m = 0;

  float noise() const { return (by_half[0] - by_half[1]) / 2; }  // its square is the variance of the irradiance in the mean
};

// The diffuse surfaces that are seen straight through the middles of the film's pixels.
std::vector<GatherPlace> seen_places(const Scene& scene);

// By strata x strata paths at each place.
std::vector<KnownPlace> gather_all(const Scene& scene, const std::vector<GatherPlace>& places, int strata, std::uint64_t seed,
                                   int threads);

// The halves of the irradiance alone.
std::vector<std::array<float, 2>> reference(const Scene& scene, const std::vector<GatherPlace>& places, int strata,
                                            std::uint64_t seed, int threads);

}  // namespace fluxfarm::ablation
