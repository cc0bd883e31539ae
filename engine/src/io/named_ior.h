// Indices of refraction of transparent materials by name, at the sodium D line (589.3 nm) against vacuum.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fluxfarm {

// Nothing if the name is unknown; upper and lower case are the same.
std::optional<float> named_ior(std::string_view name);
std::vector<std::string> ior_names();

}  // namespace fluxfarm
