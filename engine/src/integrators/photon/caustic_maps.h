// The caustic photons of one pass of progressive photon mapping: a map for each sample that the pixels take in it. Fewer and larger
// maps would tell no more about a pixel, whose samples would meet the same photons again, and take longer to look through.
//
// [KnausZwicker11] C. Knaus, M. Zwicker, "Progressive Photon Mapping: A Probabilistic Approach", ACM TOG 30(3), 2011.
// A pass is independent of all others, and its radius depends on its samples alone: r^2 falls with (samples so far)^(alpha - 1),
// alpha = 2/3, so that variance and squared bias of the mean over all passes both fall with (samples)^(-2/3) [section 4].
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "film/pixel_rect.h"
#include "integrators/integrator.h"
#include "integrators/photon/photon_map.h"
#include "integrators/photon/photon_tracer.h"
#include "integrators/photon/projection_map.h"

namespace fluxfarm {

// What the photons of each map are, but for their seed.
PhotonSettings caustic_photon_settings(const Scene& scene);

class CausticMaps final : public PreparedPass {
 public:
  // Shoots for the samples of one pass. `projection` is one for caustics and not empty, or null for none. Throws as
  // shoot_photons().
  CausticMaps(const Scene& scene, const ProjectionMap* projection, std::uint64_t seed, SampleRange samples, int threads,
              const std::atomic<bool>& cancelled);

  // For sample `index` of any pixel.
  const PhotonMap& map(std::uint32_t index) const { return maps_[index - begin_]; }
  const PhotonMap& in_media(std::uint32_t index) const { return media_maps_[index - begin_]; }
  // Of density estimates, over the side of what a pixel sees.
  float radius() const { return radius_; }
  std::uint64_t rays() const override { return rays_; }

 private:
  std::uint32_t begin_;
  std::vector<PhotonMap> maps_, media_maps_;
  float radius_;
  std::uint64_t rays_ = 0;
};

}  // namespace fluxfarm
