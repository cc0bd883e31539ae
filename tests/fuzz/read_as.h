// What the fuzzers share: bytes as a scene file, read as a user's would be.
#pragma once

#include <cstddef>
#include <cstdint>

namespace fluxfarm::fuzz {

// Reads the bytes as a scene file of that name, alone in its folder. What is no scene may be refused by SceneError or
// ResourceError; all else ends the process, and is a finding.
void read_as(const char* name, const std::uint8_t* data, std::size_t size);

}  // namespace fluxfarm::fuzz
