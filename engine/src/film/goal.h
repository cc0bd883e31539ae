// What a picture is to reach.
#pragma once

#include <cstdint>
#include <optional>

namespace fluxfarm {

// When to stop. At most one is set.
struct Goal {
  std::optional<std::uint32_t> spp;
  std::optional<double> seconds;    // wall time of the passes
  std::optional<double> rel_error;  // sqrt(relMSE), with 95 % confidence (film/error_goal.h)
};

inline constexpr std::uint32_t kDefaultSpp = 64;

// The goal, or where none is set the scene's own number of samples (0: it has none) or a default.
inline Goal settled(Goal goal, int scene_spp) {
  if (!goal.spp && !goal.seconds && !goal.rel_error) goal.spp = scene_spp > 0 ? static_cast<std::uint32_t>(scene_spp) : kDefaultSpp;
  return goal;
}

}  // namespace fluxfarm
