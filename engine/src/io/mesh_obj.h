// Wavefront OBJ: v, vt, vn and f. Groups, objects, smoothing and materials are ignored; free-form surfaces and lines, too.
#pragma once

#include <string>

#include "io/mesh_checks.h"

namespace fluxfarm {

// `text` is the whole file, `name` the file as messages show it. Polygons become fans around their first corner, so only convex
// ones come out right. Corners with equal position, texture and normal index share one vertex.
// Throws SceneError with the line for numbers that are none, are not finite, and for indices out of range.
RawMesh parse_obj(const std::string& text, const std::string& name);

}  // namespace fluxfarm
