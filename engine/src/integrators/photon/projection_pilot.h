// Measures with a few photons which cells of a projection map give photons that are stored: some shine on what hides the surfaces
// in question, or light goes from there where none is stored.
#pragma once

#include "integrators/photon/photon_tracer.h"
#include "integrators/photon/projection_map.h"

namespace fluxfarm {

// Makes `map` follow the use of its cells for photons of these settings; those of the pilot have a number and a seed of their own.
// Density goes with the root mean square of the flux that a photon leaves in the maps, which gives the sum of it the least variance
// for a number of photons that start [Neyman34]: where all of them are stored photons are equally strong, and where one of four
// is stored they are twice as strong.
//
// [Neyman34] J. Neyman, "On the Two Different Aspects of the Representative Method", J. R. Statist. Soc. 97(4), 1934.
void follow_measured_use(const Scene& scene, const PhotonSettings& settings, ProjectionMap& map);

// The map of a scene for photons of caustics with those settings, which follows their use.
ProjectionMap caustic_projection(const Scene& scene, const PhotonSettings& settings);

}  // namespace fluxfarm
