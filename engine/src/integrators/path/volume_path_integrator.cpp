#include "integrators/path/volume_path_integrator.h"

#include "integrators/path/path_group.h"
#include "integrators/path/volume_path_group.h"

namespace fluxfarm {

void VolumePathIntegrator::radiance(std::span<const CameraSample> samples, std::uint64_t seed, const PreparedPass*,
                                    std::span<SampleResult> results, RayQueries& queries) const {
  VolumePathGroup<WithoutPhotons> group(*scene_, {}, queries);
  for_each_group(samples, results,
                 [&](std::span<const CameraSample> block, std::span<SampleResult> out) { group.trace(block, seed, out); });
}

}  // namespace fluxfarm
