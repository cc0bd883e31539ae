// How the paths of a group begin: a ray through the film for each sample, and what the camera notes of the surface it meets.
#pragma once

#include <span>

#include "integrators/integrator.h"
#include "integrators/path/path_vertex.h"
#include "sampling/sampler.h"

namespace fluxfarm {

inline constexpr std::uint32_t kFilmDimension = 0;
// Counted from the other end, so that a lens moves no dimension of the paths behind it.
inline constexpr std::uint32_t kLensDimension = 0xffffffffu;

// Fills `sampler` with the samples of one group, and `rays` with a ray for each of them.
void start_camera_rays(const Scene& scene, std::span<const CameraSample> samples, std::uint64_t seed, SamplerBatch& sampler,
                       std::span<Ray> rays);

inline void note_first_hit(const Camera& camera, const PathVertex& vertex, SampleResult& result) {
  result.hit = true;
  result.depth = camera.depth(vertex.point.position);
  result.normal = vertex.wo.z < 0 ? -vertex.frame.n : vertex.frame.n;
  result.albedo = vertex.bsdf->albedo(vertex.wo);
}

}  // namespace fluxfarm
