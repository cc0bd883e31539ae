#include "integrators/path/path_integrator.h"

#include "integrators/path/path_group.h"

namespace fluxfarm {
namespace {

// A type of this file alone makes the group's functions its own, too, so that those that are called once are inlined: 4 % of the
// instructions of a path.
class NoPhotons : public WithoutPhotons {};

}  // namespace

void PathIntegrator::radiance(std::span<const CameraSample> samples, std::uint64_t seed, const PreparedPass*,
                              std::span<SampleResult> results, RayQueries& queries) const {
  PathGroup<NoPhotons> group(*scene_, {}, queries);
  for_each_group(samples, results,
                 [&](std::span<const CameraSample> block, std::span<SampleResult> out) { group.trace(block, seed, out); });
}

}  // namespace fluxfarm
