// Limits that keep a hostile or mistaken scene from taking the machine down. README.md lists them for users.
#pragma once

#include <cstddef>
#include <cstdint>

namespace fluxfarm {

inline constexpr std::uintmax_t kMaxSceneTextBytes = 64u << 20;                // one XML or JSON file
inline constexpr std::uintmax_t kMaxMeshFileBytes = std::uintmax_t{2} << 30;   // one OBJ or PLY file
inline constexpr int kMaxNesting = 64;                                         // elements within elements
inline constexpr int kMaxIncludeDepth = 16;                                    // files that include files
inline constexpr int kMaxIncludes = 256;                                       // <include> elements followed in one scene
inline constexpr std::size_t kMaxAttributeLength = 64u << 10;                  // an XML attribute, also after $name substitution
inline constexpr std::size_t kMaxNameLength = 256;                             // of an XML element or a JSON member
inline constexpr std::size_t kMaxPlacedMeshes = std::size_t{1} << 20;          // of one glTF file, instances included
inline constexpr std::size_t kMaxNodeDepth = 1024;                             // glTF nodes within nodes
inline constexpr std::uint64_t kMaxAccessorElements = std::uint64_t{1} << 28;  // of one accessor, and of all that meshes read
inline constexpr std::uint64_t kMaxZeroElements = std::uint64_t{1} << 24;      // of an accessor that has no bytes of its own
inline constexpr std::int64_t kMaxImageSide = 65536;                           // pixels
inline constexpr std::int64_t kMaxImagePixels = std::int64_t{1} << 27;
inline constexpr std::size_t kMaxTexturePixels = std::size_t{1} << 29;  // of all images of a scene together

}  // namespace fluxfarm
