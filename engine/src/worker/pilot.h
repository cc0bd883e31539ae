// The pilot of "auto": tries the methods that may suit a scene on the same few tiles, and takes the one that reaches the goal with
// the least work.
//
// All take the same samples there, so that chance weighs on all alike, and the longer the more is at stake. A method is tried only
// where it may gain more than its trial costs. The choice depends on the scene, the crop, the seed and the goal alone.
//
// Paths may not have met light that mirrors and gloss throw, which photons carry. What it will add to their noise is told by the
// side of the light (integrators/audit/light_audit.h), or by the caustics that photons see.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "film/goal.h"
#include "film/pixel_rect.h"
#include "integrators/integrator.h"
#include "integrators/plan/method_choice.h"
#include "worker/pilot_samples.h"

namespace fluxfarm {

// The picture for which a method is to be chosen.
struct Picture {
  PixelRect crop;
  std::uint64_t seed = 0;
  Goal goal;
};

struct Method {
  std::unique_ptr<Integrator> integrator;  // prepared
  std::optional<MethodChoice> choice;      // of "auto"
  PilotSamples known;                      // of the picture
};

// As make_integrator(), and "auto": what the pilot chooses. "" is the scene's own. Throws CancelledError soon after `cancelled`
// becomes true.
Method make_method(const std::string& name, const Scene& scene, const Picture& picture, int threads,
                   const std::atomic<bool>& cancelled);

}  // namespace fluxfarm
