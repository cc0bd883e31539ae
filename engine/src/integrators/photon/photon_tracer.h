// Follows photons from the emitters through the scene and stores them where they land.
//
// [Jensen96] H. W. Jensen, "Global Illumination using Photon Maps", EGWR 1996.
// Scattering is the BSDF's own sampling, which chooses between its lobes; Russian roulette then keeps the flux of a photon: with
// P = max over channels (flux after) / max over channels (flux at emission) it goes on with 1/P of what is left. For a photon that
// lost no colour yet P is the largest reflectance, diffuse and specular together, as in [Jensen96]. So photons of one emitter stay
// equally strong, which is what density estimates want.
//
// Photons are stored at surfaces with a continuous lobe, at every bounce.
//
// In media a photon flies as a path does (media/channel_mis.h) and collides: an event like any other, with the albedo for a
// reflectance and the phase function for a lobe. It is stored at every collision with the flux that is scattered there, so that
// flux over volume is what the medium scatters of the light that crosses it. Null boundaries are no events.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "accel/ray_queries.h"
#include "integrators/light_flux.h"
#include "integrators/photon/flux_ledger.h"
#include "integrators/photon/photon.h"
#include "integrators/photon/projection_map.h"
#include "scene/scene.h"

namespace fluxfarm {

// What is shot. Photon i depends on the scene, these settings and i alone, but for the last bits of what a packet of rays gives.
struct PhotonSettings {
  std::uint64_t photons = 0;  // shot in all: each carries one so-many-th of the power
  std::uint64_t seed = 0;
  int max_bounces = -1;  // surfaces and collisions on the way, with the one where the photon is stored; -1 is unlimited
  PhotonKinds kinds = PhotonKinds::all();
};

// What photons leave on their way.
struct StoredPhotons {
  std::vector<Photon> photons;   // at surfaces
  std::vector<Photon> in_media;  // at collisions: flux that is scattered there
};

class PhotonTracer {
 public:
  // Photons that are followed side by side.
  static constexpr std::size_t kGroup = 64;

  // From the emitters in proportion to their power. Throws SettingError if there is nothing to shoot, or nothing that could store
  // it.
  PhotonTracer(const Scene& scene, const PhotonSettings& settings);
  // From the parts of the emitters that `projection` keeps and with its densities. It must outlive this, and be made for all
  // surfaces on which light may fall first to become one of the kinds.
  PhotonTracer(const Scene& scene, const PhotonSettings& settings, const ProjectionMap& projection);

  // Of photon `index`: its place in [0,1) among the emitters. `random` is its own, unused so far.
  double place(std::uint64_t index, KeyRandom& random) const {
    return (static_cast<double>(index) + static_cast<double>(random.next_1d())) / static_cast<double>(settings_.photons);
  }

  // Follows photons first ... first + count - 1, count <= kGroup. Appends what they leave, in an order that is fixed.
  void trace(std::uint64_t first, std::size_t count, RayQueries& queries, StoredPhotons& stored, FluxLedger& ledger) const;

 private:
  class Group;

  const Scene& scene_;
  PhotonSettings settings_;
  ParticleSource source_;
  const ProjectionMap* projection_ = nullptr;  // null: all that is emitted
  bool media_ = false;                         // or null boundaries: surfaces have two sides
  bool media_change_ = false;                  // not all of the scene lies in the camera's medium
};

}  // namespace fluxfarm
