// Cuts a batch of camera samples into groups that advance together: those of one pixel, at most one pass of it.
#pragma once

#include <span>

#include "integrators/integrator.h"
#include "sampling/sampler.h"

namespace fluxfarm {

// Paths that advance together.
inline constexpr std::size_t kMaxPaths = kMaxSamplerBatch;

// Calls trace(samples, results) for each group, in order.
template <typename Trace>
void for_each_pixel_group(std::span<const CameraSample> samples, std::span<SampleResult> results, const Trace& trace) {
  for (std::size_t begin = 0; begin < samples.size();) {
    std::size_t end = begin + 1;
    while (end < samples.size() && end - begin < kMaxPaths && samples[end].x == samples[begin].x &&
           samples[end].y == samples[begin].y) {
      ++end;
    }
    trace(samples.subspan(begin, end - begin), results.subspan(begin, end - begin));
    begin = end;
  }
}

}  // namespace fluxfarm
