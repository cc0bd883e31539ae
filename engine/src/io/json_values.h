// The values of Mitsuba's dict form that are not plain numbers: vectors, colours and transforms.
#pragma once

#include <optional>
#include <string>

#include "io/json_value.h"
#include "io/plugin_tree.h"

namespace fluxfarm {

// A number, integer or not.
std::optional<double> json_number(const JsonValue& json);

// The value of a member that is not a plugin: number, boolean, text, [x, y, z], {"type": "rgb"}, {"type": "spectrum"} or a
// transform (a 4 x 4 array or an array of steps). Throws SceneError at `place`. README.md describes the steps.
PropertyValue read_json_value(const JsonValue& json, const std::string& place);

}  // namespace fluxfarm
