// From the description of an emitter without a shape to the Emitter that carries it out.
#pragma once

#include <memory>

#include "emitters/emitter.h"
#include "scene/description.h"

namespace fluxfarm {

// `scene_radius` (m): of a sphere around all shapes, 0 without any. Null for a constant environment, which cannot be sampled.
std::unique_ptr<Emitter> make_emitter(const EmitterDescription& description, float scene_radius);

}  // namespace fluxfarm
