// Which samples each progressive pass takes: 1, 1, 2, 4, ... doubling the total up to a ceiling a pass.
//
// A pass is the unit in which sums are rounded and added, so the schedule is part of what makes pixels reproducible: engine and
// service use the same one (service: domain/schedule.py; tests/contract/test_same_numbers.py compares the ceiling,
// tests/render/test_same_bits.py what comes of it).
#pragma once

#include <algorithm>
#include <cstdint>

#include "film/pixel_rect.h"

namespace fluxfarm {

inline constexpr std::uint32_t kMaxSamplesPerPass = 64;

// The pass that follows when every pixel has `done` samples. `goal`: samples per pixel at which to end; done < goal.
constexpr SampleRange next_pass(std::uint32_t done, std::uint32_t goal) {
  const std::uint32_t size = std::clamp<std::uint32_t>(done, 1, kMaxSamplesPerPass);
  return {done, std::min(done + size, goal)};
}

}  // namespace fluxfarm
