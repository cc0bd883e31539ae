// Path tracing: next-event estimation and BSDF sampling, joined by multiple importance sampling. Unbiased.
//
// Parameters (MethodDescription): max_depth, path edges, -1 without limit: a finite one is biased, it leaves longer paths out;
// rr_depth, the first bounce at which Russian roulette may end a path; hide_emitters.
// Good for: diffuse and glossy scenes with lights that can be seen from most places. Poor for: caustics from small lights, light
// through small openings; a point light seen only through glass is never found (catalogue 4.8, C8).
//
// A path is an absorbing Markov chain: at each bounce it survives with a probability that follows its throughput, and the
// survivors are weighted up by it, so the expectation is unchanged.
//
// The samples of a block of pixels advance together, bounce by bounce, so that their rays can be traced in packets; which rays
// share a packet then depends on the block and the pass alone, and so does every bit of the result.
#pragma once

#include "integrators/integrator.h"

namespace fluxfarm {

class PathIntegrator final : public Integrator {
 public:
  const char* name() const override { return "path"; }
  void prepare(const Scene& scene) override { scene_ = &scene; }
  void radiance(std::span<const CameraSample> samples, std::uint64_t seed, const PreparedPass* pass,
                std::span<SampleResult> results, RayQueries& queries) const override;

 private:
  const Scene* scene_ = nullptr;
};

}  // namespace fluxfarm
