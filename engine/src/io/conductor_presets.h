// Complex indices of refraction of metals by the names that Mitsuba's `material` parameter knows.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "math/rgb.h"

namespace fluxfarm {

// Index eta - i k against vacuum, linear Rec.709.
struct ConductorPreset {
  Rgb eta, k;
};

// Nothing if the name is unknown. "none" (a perfect mirror) is not in the table.
std::optional<ConductorPreset> conductor_preset(std::string_view name);
std::vector<std::string> conductor_preset_names();

}  // namespace fluxfarm
