// The light-side audit: does path tracing find the light that leaves the emitters?
//
// Particles of light are followed from the emitters and splatted into the coarse cells of the picture. Their estimate shares no
// sampling with that of the paths from the camera, so light that those never met shows up here. film/unseen_error.h compares the
// two.
//
// It is blind to what is seen in or through smooth surfaces and does not follow the constant environment, which paths from the
// camera find with bounded weights. Participating media are not modelled.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "film/light_audit.h"
#include "film/pixel_rect.h"
#include "scene/scene.h"

namespace fluxfarm {

// Whether a scene is audited, and why. `unreachable`: it cannot be, and has what makes light that no path finds.
struct AuditNeed {
  enum Kind { kNeeded, kNotNeeded, kNotPossible } kind;
  std::string reason;
  bool unreachable = false;
};
AuditNeed audit_need(const Scene& scene);

// The audit of the part `crop` of the frame; of a scene that needs none, one that finds nothing; where it is not possible, one
// without cells that says so. `finds_caustics`: as the method's answer, by which no light counts as unreachable. Depends on the
// first three and on it alone. Throws CancelledError soon after `cancelled` becomes true.
LightAudit audit_light(const Scene& scene, PixelRect crop, std::uint64_t seed, int threads, const std::atomic<bool>& cancelled,
                       bool finds_caustics = false);

}  // namespace fluxfarm
