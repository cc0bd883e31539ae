// What a transform does to lengths and angles.
#pragma once

#include <cstddef>

#include "math/transform.h"

namespace fluxfarm {

// Factor by which the transform stretches that axis (0 to 2).
double axis_scale(const Transform& transform, std::size_t axis);

// Whether the first `count` axes stay perpendicular to each other and are stretched by one factor greater than zero. Tells a
// turned, moved, mirrored or enlarged body from a distorted one.
bool keeps_shape(const Transform& transform, std::size_t count);

}  // namespace fluxfarm
