// Balls around surfaces: what a projection map asks whether light may meet it.
#pragma once

#include <cstdint>
#include <vector>

#include "emitters/emission_bounds.h"
#include "scene/scene.h"

namespace fluxfarm {

// The surfaces on which light must fall to make a caustic, as indices for Scene::surface(): all but diffuse ones.
std::vector<std::uint32_t> glossy_shapes(const Scene& scene);

// Balls that hold the surfaces together, in a fixed order: one for a sphere, and several for what a ball fits badly, so that a
// pane or a surface of water is covered closely.
std::vector<Ball> bounding_balls(const Scene& scene, const std::vector<std::uint32_t>& shapes);

}  // namespace fluxfarm
