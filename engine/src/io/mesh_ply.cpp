#include "io/mesh_ply.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "io/ply_header.h"
#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

// Takes one value after another from the rows of the file.
class PlyRows {
 public:
  PlyRows(const std::string& file, const PlyHeader& header, const std::string& name)
      : file_(file), name_(name), encoding_(header.encoding), position_(header.size) {}

  double take(PlyType type) { return encoding_ == PlyEncoding::kAscii ? take_ascii() : take_binary(type); }

  std::uint64_t bytes_left() const { return file_.size() - position_; }

  // Names the row in messages.
  void start_row(const std::string& element, std::uint64_t row) {
    element_ = &element;
    row_ = row;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw SceneError(name_, (element_ ? *element_ + " " + std::to_string(row_) + ": " : std::string()) + what);
  }

 private:
  double take_ascii() {
    constexpr const char* kBlanks = " \t\r\n";
    const std::size_t start = file_.find_first_not_of(kBlanks, position_);
    if (start == std::string::npos) fail("the file ends here, expected another number");
    const std::size_t end = std::min(file_.find_first_of(kBlanks, start), file_.size());
    position_ = end;
    const std::string_view word = std::string_view(file_).substr(start, end - start);
    const std::optional<double> value = parse_number(word);
    if (!value) fail(in_quotes(word) + ", expected a number");
    return *value;
  }

  double take_binary(PlyType type) {
    std::array<char, 8> bytes{};
    const std::size_t size = size_of(type);
    if (bytes_left() < size) fail("the file ends here, expected another number");
    std::memcpy(bytes.data(), file_.data() + position_, size);
    position_ += size;
    const bool file_is_little = encoding_ == PlyEncoding::kBinaryLittleEndian;
    if (file_is_little != (std::endian::native == std::endian::little)) std::reverse(bytes.begin(), bytes.begin() + size);
    switch (type) {
      case PlyType::kInt8: return as<std::int8_t>(bytes);
      case PlyType::kUint8: return as<std::uint8_t>(bytes);
      case PlyType::kInt16: return as<std::int16_t>(bytes);
      case PlyType::kUint16: return as<std::uint16_t>(bytes);
      case PlyType::kInt32: return as<std::int32_t>(bytes);
      case PlyType::kUint32: return as<std::uint32_t>(bytes);
      case PlyType::kFloat32: return static_cast<double>(as<float>(bytes));
      case PlyType::kFloat64: return as<double>(bytes);
    }
    return 0;
  }

  template <typename Value>
  static Value as(const std::array<char, 8>& bytes) {
    Value value;
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }

  const std::string& file_;
  const std::string& name_;
  PlyEncoding encoding_;
  std::size_t position_;
  const std::string* element_ = nullptr;
  std::uint64_t row_ = 0;
};

void check_count(const PlyElement& element, const PlyHeader& header, const PlyRows& rows) {
  const std::uint64_t row = element.smallest_row(header.encoding);
  // Rows of nothing take no room; no element of ours may consist of them.
  const std::uint64_t fits = row == 0 ? UINT64_MAX : (rows.bytes_left() + 1) / row;
  if (element.count > fits || element.count >= UINT32_MAX) {
    rows.fail("the header promises " + std::to_string(element.count) + " rows of " + in_quotes(element.name) + ", but " +
              std::to_string(rows.bytes_left()) + " bytes are left in the file; it is cut off or its header is wrong");
  }
}

std::uint64_t take_length(PlyRows& rows, const PlyHeader& header, const PlyProperty& property) {
  const double length = rows.take(property.count_type);
  const std::uint64_t smallest = header.encoding == PlyEncoding::kAscii ? 2 : size_of(property.type);
  const std::uint64_t most = (rows.bytes_left() + 1) / smallest;
  if (!(length >= 0) || length != std::floor(length) || length > static_cast<double>(most)) {
    rows.fail("list " + in_quotes(property.name) + " has a length of " + number_text(length) + ", but " +
              std::to_string(rows.bytes_left()) + " bytes are left in the file");
  }
  return static_cast<std::uint64_t>(length);
}

void skip(PlyRows& rows, const PlyHeader& header, const PlyProperty& property) {
  const std::uint64_t values = property.list ? take_length(rows, header, property) : 1;
  for (std::uint64_t i = 0; i < values; ++i) rows.take(property.type);
}

void skip_element(PlyRows& rows, const PlyHeader& header, const PlyElement& element) {
  if (element.properties.empty()) return;
  for (std::uint64_t row = 0; row < element.count; ++row) {
    rows.start_row(element.name, row);
    for (const PlyProperty& property : element.properties) skip(rows, header, property);
  }
}

// Places of the texture coordinates among the properties, or -1.
std::array<int, 2> find_uvs(const PlyElement& vertex) {
  constexpr std::pair<const char*, const char*> kNames[] = {
      {"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}};
  for (const auto& [u, v] : kNames) {
    if (vertex.find(u) >= 0 && vertex.find(v) >= 0) return {vertex.find(u), vertex.find(v)};
  }
  return {-1, -1};
}

// Places of the colour among the properties, or -1.
std::array<int, 3> find_color(const PlyElement& vertex) {
  const std::array<int, 3> letters{vertex.find("r"), vertex.find("g"), vertex.find("b")};
  if (*std::min_element(letters.begin(), letters.end()) >= 0) return letters;
  return {vertex.find("red"), vertex.find("green"), vertex.find("blue")};
}

// What a colour of one means in that type: the greatest integer.
float one_in(PlyType type) {
  switch (type) {
    case PlyType::kInt8: return 127;
    case PlyType::kUint8: return 255;
    case PlyType::kInt16: return 32767;
    case PlyType::kUint16: return 65535;
    case PlyType::kInt32: return 2147483647.0f;
    case PlyType::kUint32: return 4294967295.0f;
    case PlyType::kFloat32:
    case PlyType::kFloat64: return 1;
  }
  return 1;
}

void read_vertices(PlyRows& rows, const PlyHeader& header, const PlyElement& element, RawMesh& mesh) {
  const std::array<int, 3> position{element.find("x"), element.find("y"), element.find("z")};
  const std::array<int, 3> normal{element.find("nx"), element.find("ny"), element.find("nz")};
  const std::array<int, 2> uv = find_uvs(element);
  if (*std::min_element(position.begin(), position.end()) < 0) rows.fail("the vertices lack x, y or z");
  const bool has_normals = *std::min_element(normal.begin(), normal.end()) >= 0;
  const bool has_uvs = uv[0] >= 0;
  const std::array<int, 3> color = find_color(element);
  const bool has_colors = *std::min_element(color.begin(), color.end()) >= 0;

  std::vector<float> row(element.properties.size());
  mesh.positions.reserve(element.count);
  for (std::uint64_t i = 0; i < element.count; ++i) {
    rows.start_row(element.name, i);
    for (std::size_t p = 0; p < row.size(); ++p) {
      if (element.properties[p].list) {
        skip(rows, header, element.properties[p]);
      } else {
        row[p] = static_cast<float>(rows.take(element.properties[p].type));
      }
    }
    const auto value = [&](int p) { return row[static_cast<std::size_t>(p)]; };
    mesh.positions.push_back({value(position[0]), value(position[1]), value(position[2])});
    if (has_normals) mesh.normals.push_back({value(normal[0]), value(normal[1]), value(normal[2])});
    const auto part = [&](int p) { return value(p) / one_in(element.properties[static_cast<std::size_t>(p)].type); };
    if (has_colors) mesh.colors.push_back({part(color[0]), part(color[1]), part(color[2])});
    if (has_uvs) mesh.uvs.push_back({value(uv[0]), value(uv[1])});
  }
}

void read_polygon(PlyRows& rows, const PlyHeader& header, const PlyProperty& property, std::uint64_t vertices, RawMesh& mesh) {
  const std::uint64_t corners = take_length(rows, header, property);
  if (corners < 3) rows.fail("has " + std::to_string(corners) + " corners, expected at least 3");
  std::uint32_t first = 0, previous = 0;
  for (std::uint64_t i = 0; i < corners; ++i) {
    const double index = rows.take(property.type);
    if (!(index >= 0) || index >= static_cast<double>(vertices) || index != std::floor(index)) {
      rows.fail("refers to vertex " + number_text(index) + ", expected an index from 0 to " + std::to_string(vertices - 1));
    }
    const auto corner = static_cast<std::uint32_t>(index);
    if (i == 0) first = corner;
    if (i >= 2) mesh.indices.insert(mesh.indices.end(), {first, previous, corner});
    previous = corner;
  }
}

void read_faces(PlyRows& rows, const PlyHeader& header, const PlyElement& element, std::uint64_t vertices, RawMesh& mesh) {
  const int list = std::max(element.find("vertex_indices"), element.find("vertex_index"));
  if (list < 0 || !element.properties[static_cast<std::size_t>(list)].list) rows.fail("the faces lack the list vertex_indices");
  mesh.indices.reserve(3 * element.count);
  for (std::uint64_t i = 0; i < element.count; ++i) {
    rows.start_row(element.name, i);
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      if (static_cast<int>(p) == list) {
        read_polygon(rows, header, element.properties[p], vertices, mesh);
      } else {
        skip(rows, header, element.properties[p]);
      }
    }
  }
}

}  // namespace

RawMesh parse_ply(const std::string& file, const std::string& name) {
  const PlyHeader header = parse_ply_header(file, name);
  RawMesh mesh;
  mesh.name = name;
  PlyRows rows(file, header, name);
  const auto vertex =
      std::find_if(header.elements.begin(), header.elements.end(), [](const PlyElement& e) { return e.name == "vertex"; });
  if (vertex == header.elements.end() || vertex->count == 0) rows.fail("has no vertices");
  for (const PlyElement& element : header.elements) {
    check_count(element, header, rows);
    if (element.name == "vertex" && mesh.positions.empty()) {
      read_vertices(rows, header, element, mesh);
    } else if (element.name == "face") {
      read_faces(rows, header, element, vertex->count, mesh);
    } else {
      skip_element(rows, header, element);
    }
  }
  if (mesh.indices.empty()) throw SceneError(name, "has no faces");
  return mesh;
}

}  // namespace fluxfarm
