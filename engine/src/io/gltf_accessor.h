// Accessors: typed elements in the buffers of a glTF file, all component types, normalised integers, strides and sparse ones.
#pragma once

#include <cstdint>
#include <vector>

#include "io/gltf_file.h"

namespace fluxfarm {

// Number of elements that an accessor claims, at most kMaxAccessorElements. Nothing is opened.
std::uint64_t accessor_count(const GltfFile& file, std::size_t accessor);

// The elements one after another, as floats: normalised integers in [0, 1] or [-1, 1], other integers as they are. `components` is
// 1 for SCALAR, 2 to 4 for VEC2 to VEC4. Throws SceneError for another type and for bytes outside the buffer view.
std::vector<float> read_floats(GltfFile& file, std::size_t accessor, std::size_t components);

// A SCALAR of unsigned integers.
std::vector<std::uint32_t> read_indices(GltfFile& file, std::size_t accessor);

}  // namespace fluxfarm
