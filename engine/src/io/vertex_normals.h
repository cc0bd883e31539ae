// Vertex normals from the triangles around each vertex.
//
// [Thuermer98] G. Thuermer, C. A. Wuethrich, "Computing Vertex Normals from Polygonal Facets", JGT 3(1), 1998.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "math/vec.h"

namespace fluxfarm {

// (b - a) x (c - a) in double precision: twice the area long, exactly zero for triangles that are flat in single precision.
std::array<double, 3> face_normal(Vec3f a, Vec3f b, Vec3f c);

// Where `normals` is 0 0 0, or empty, puts the mean of the unit normals of the triangles that share the vertex, weighted by
// their angle there [Thuermer98], as Mitsuba does. Where this mean vanishes, the normal of one of these triangles; a vertex of
// no triangle gets +z. No triangle may have zero area.
void fill_missing_normals(const std::vector<Vec3f>& positions, const std::vector<std::uint32_t>& indices,
                          std::vector<Vec3f>& normals);

}  // namespace fluxfarm
