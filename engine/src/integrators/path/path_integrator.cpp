#include "integrators/path/path_integrator.h"

#include "integrators/path/path_group.h"

namespace fluxfarm {

void PathIntegrator::radiance(std::span<const CameraSample> samples, std::uint64_t seed, const PreparedPass*,
                              std::span<SampleResult> results, RayQueries& queries) const {
  PathGroup<WithoutPhotons> group(*scene_, {}, queries);
  for_each_group(samples, results,
                 [&](std::span<const CameraSample> block, std::span<SampleResult> out) { group.trace(block, seed, out); });
}

}  // namespace fluxfarm
