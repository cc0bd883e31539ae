// The steps that a `transform` is made of, checked; shared by the XML and the JSON reader.
#pragma once

#include <string>
#include <vector>

#include "io/plugin_tree.h"
#include "math/transform.h"

namespace fluxfarm {

// All throw SceneError at `place` when the result would not be an invertible or at least finite affine map.
// `values`: 16 numbers of a 4 x 4 or 9 of a 3 x 3 matrix, row-major; the last row of a 4 x 4 must be 0 0 0 w with w not 0.
Transform matrix_step(const std::vector<double>& values, const std::string& place);
Transform rotate_step(const Triple& axis, double angle_degrees, const std::string& place);
Transform look_at_step(const Triple& origin, const Triple& target, const Triple& up, const std::string& place);

}  // namespace fluxfarm
