// From the description of a shape to the Shape that carries it out, and into the ray accelerator.
#pragma once

#include <memory>

#include "accel/ray_accelerator.h"
#include "geometry/shape.h"
#include "scene/description.h"

namespace fluxfarm {

// Makes the shape and adds it to `accelerator`. `emissive`: it will be sampled as a light.
std::unique_ptr<Shape> add_shape(const ShapeDescription& description, bool emissive, RayAccelerator& accelerator);

}  // namespace fluxfarm
