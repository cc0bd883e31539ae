// The photons of one pass of photon mapping: for each replicate a map of caustics and one of all other indirect light.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "integrators/integrator.h"
#include "integrators/photon/photon_map.h"
#include "integrators/photon/photon_tracer.h"
#include "integrators/photon/projection_map.h"
#include "sampling/sampler.h"

namespace fluxfarm {

// What the photons of those kinds are that are shot for one sample of the pixels, but for their seed.
PhotonSettings global_photon_settings(const Scene& scene, PhotonKinds kinds);

class GlobalMaps final : public PreparedPass {
 public:
  // `projection` is one for caustics. Throws as shoot_photons().
  GlobalMaps(const Scene& scene, const ProjectionMap& projection, std::uint64_t seed, SampleRange samples, int threads,
             const std::atomic<bool>& cancelled);

  // For sample `index` of any pixel.
  const PhotonMap& caustics(std::uint32_t index) const { return caustics_[index % kReplicates]; }
  const PhotonMap& indirect(std::uint32_t index) const { return indirect_[index % kReplicates]; }
  std::uint64_t rays() const override { return rays_; }

 private:
  std::array<PhotonMap, kReplicates> caustics_, indirect_;
  std::uint64_t rays_ = 0;
};

}  // namespace fluxfarm
