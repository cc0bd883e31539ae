// What photons in a medium tell about the light that it scatters: the sum of their flux over the volume that they lie in.
//
// [Jarosz08] W. Jarosz, M. Zwicker, H. W. Jensen, "The Beam Radiance Estimate for Volumetric Photon Mapping", Computer Graphics
// Forum 27(2), 2008.
//
// Photons carry the flux that collisions scatter (photon_tracer.h): over volume it is the medium's scattering coefficient times the
// light that crosses, so the estimate does not ask for the coefficient. Biased: the light of the disk around a place of the ray is
// taken for that of its middle; the radius controls it. Near the border of a medium it is too small by the part outside, and where
// two media meet it takes photons of both.
#pragma once

#include "integrators/photon/density_kernel.h"
#include "integrators/photon/photon_map.h"
#include "integrators/photon/sharpness.h"
#include "media/homogeneous_medium.h"

namespace fluxfarm {

// What a beam brings to its origin, W m^-2 sr^-1.
struct BeamRadiance {
  Rgb value;
  Rgb bias;  // of it, from what half the area of the beam brings
};

// By the photons in the beam that met fewer than `room` surfaces and collisions. What the medium would scatter sharply is left
// out: that light is for the next place on its way.
inline BeamRadiance scattered_along(const PhotonMap& map, const Beam& beam, const HomogeneousMedium& medium, int room) {
  constexpr EpanechnikovKernel kKernel;
  Rgb wide, narrow;
  map.for_each_in(beam, [&](float distance, float across, const PhotonLight& light) {
    if (light.surfaces() >= room) return;
    const float radius = beam.radius_at(distance), area = kPi * radius * radius;
    const float f = medium.phase().value(beam.direction, normalize(light.wi()));
    const Rgb scattered = light.flux() * medium.transmittance(distance) * (f * (1 - sharpness(1 / f)) / area);
    wide += scattered * kKernel.weight(across);
    if (across < 0.5f) narrow += scattered * (2 * kKernel.weight(2 * across));
  });
  return {wide, (wide - narrow) * kBiasPerDifference};
}

}  // namespace fluxfarm
