// What this build of the engine is: part of what makes pixels reproducible.
#pragma once

#include <string>

namespace fluxfarm {

// Version, sources, compiler and instruction set of the build.
std::string engine_build();
std::string engine_version();
std::string compiler();
std::string build_options();
// Instruction set that the engine itself was compiled for (Embree chooses its own when it starts).
std::string instruction_set();

}  // namespace fluxfarm
