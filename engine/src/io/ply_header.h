// The header of a PLY file: which elements follow, with which properties, in which encoding.
//
// [Turk94] G. Turk, "The PLY Polygon File Format", 1994.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace fluxfarm {

enum class PlyEncoding { kAscii, kBinaryLittleEndian, kBinaryBigEndian };
enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

std::size_t size_of(PlyType type);  // bytes in a binary file

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;  // of the value, or of the elements of a list
  bool list = false;
  PlyType count_type = PlyType::kUint8;  // of the length of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  // Index of the property of that name, or -1.
  int find(const std::string& property) const;
  // Bytes that one row takes at least.
  std::uint64_t smallest_row(PlyEncoding encoding) const;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::vector<PlyElement> elements;
  std::size_t size = 0;  // bytes up to the first row
};

// Throws SceneError with the line if the header is not one.
PlyHeader parse_ply_header(const std::string& file, const std::string& name);

}  // namespace fluxfarm
