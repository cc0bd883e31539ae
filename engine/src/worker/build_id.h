// The identity of an engine: its build and the ray library that it found. Two engines with the same one give the same bits.
#pragma once

#include <string>

namespace fluxfarm {

std::string engine_build_id();

}  // namespace fluxfarm
