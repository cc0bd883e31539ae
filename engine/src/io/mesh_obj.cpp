#include "io/mesh_obj.h"

#include <charconv>
#include <cmath>
#include <string_view>

#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

// The first word of a line, removed from it; empty at the end of the line.
std::string_view take_word(std::string_view& line) {
  constexpr std::string_view kBlanks = " \t\r";
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
  line.remove_prefix(word.size());
  return word;
}

class ObjParser {
 public:
  explicit ObjParser(const std::string& name) { mesh_.name = name; }

  void parse_line(std::string_view line) {
    ++line_number_;
    const std::string_view keyword = take_word(line);
    if (keyword == "v") {
      positions_.push_back(read_vector(line));
    } else if (keyword == "vn") {
      normals_.push_back(read_vector(line));
    } else if (keyword == "vt") {
      const float u = read_float(line);
      std::string_view rest = line;
      uvs_.push_back({u, take_word(rest).empty() ? 0.0f : read_float(line)});
    } else if (keyword == "f") {
      read_face(line);
    }
  }

  RawMesh result() {
    if (!has_normals_) mesh_.normals.clear();
    if (!has_uvs_) mesh_.uvs.clear();
    return std::move(mesh_);
  }

 private:
  // One combination of texture and normal index met at a position; a list for each position.
  struct Corner {
    std::int64_t uv, normal;
    std::int64_t next;  // vertex with the same position, or -1
  };

  [[noreturn]] void fail(const std::string& what) const { throw SceneError(mesh_.name + ":" + std::to_string(line_number_), what); }

  float read_float(std::string_view& line) const {
    const std::string_view word = take_word(line);
    if (word.empty()) fail("the line ends early, expected another number");
    const std::optional<double> value = parse_number(word);
    if (!value || !std::isfinite(static_cast<float>(*value))) fail(in_quotes(word) + ", expected a finite number");
    return static_cast<float>(*value);
  }

  Vec3f read_vector(std::string_view& line) const {
    const float x = read_float(line), y = read_float(line), z = read_float(line);
    return {x, y, z};
  }

  // One-based or, if negative, counted back from the newest: made zero-based.
  std::int64_t read_index(std::string_view text, std::size_t count, const char* noun) const {
    const std::optional<std::int64_t> value = parse_integer(text);
    if (!value) fail("the face has " + in_quotes(text) + ", expected the index of a " + noun);
    const auto size = static_cast<std::int64_t>(count);
    if (*value == 0 || *value > size || *value < -size) {
      fail("the face refers to " + std::string(noun) + " " + std::to_string(*value) + ", expected 1 to " + std::to_string(size) +
           " or -1 to -" + std::to_string(size));
    }
    return *value > 0 ? *value - 1 : size + *value;
  }

  // "7", "7/1", "7//3" or "7/1/3" as the index of a vertex.
  std::uint32_t read_corner(std::string_view word) {
    const std::size_t first = word.find('/');
    const std::size_t second = first == std::string_view::npos ? first : word.find('/', first + 1);
    const std::int64_t position = read_index(word.substr(0, first), positions_.size(), "vertex");
    std::int64_t uv = -1, normal = -1;
    if (first != std::string_view::npos) {
      const std::string_view text = word.substr(first + 1, second == std::string_view::npos ? second : second - first - 1);
      if (!text.empty()) uv = read_index(text, uvs_.size(), "texture coordinate");
    }
    if (second != std::string_view::npos) normal = read_index(word.substr(second + 1), normals_.size(), "normal");
    return vertex(static_cast<std::size_t>(position), uv, normal);
  }

  std::uint32_t vertex(std::size_t position, std::int64_t uv, std::int64_t normal) {
    first_vertex_.resize(positions_.size(), -1);
    std::int64_t found = first_vertex_[position];
    while (found >= 0 && !(corners_[at(found)].uv == uv && corners_[at(found)].normal == normal)) found = corners_[at(found)].next;
    if (found >= 0) return static_cast<std::uint32_t>(found);
    if (corners_.size() > UINT32_MAX - 1) fail("the mesh has more vertices than 32 bits can count");

    const auto fresh = static_cast<std::int64_t>(corners_.size());
    corners_.push_back({uv, normal, first_vertex_[position]});
    first_vertex_[position] = fresh;
    mesh_.positions.push_back(positions_[position]);
    mesh_.uvs.push_back(uv < 0 ? Vec2f{} : uvs_[at(uv)]);
    mesh_.normals.push_back(normal < 0 ? Vec3f{} : normals_[at(normal)]);
    has_uvs_ = has_uvs_ || uv >= 0;
    has_normals_ = has_normals_ || normal >= 0;
    return static_cast<std::uint32_t>(fresh);
  }

  void read_face(std::string_view line) {
    std::uint32_t first = 0, previous = 0;
    std::size_t corners = 0;
    for (std::string_view word = take_word(line); !word.empty() && word[0] != '#'; word = take_word(line)) {
      const std::uint32_t corner = read_corner(word);
      if (corners == 0) first = corner;
      if (corners >= 2) mesh_.indices.insert(mesh_.indices.end(), {first, previous, corner});
      previous = corner;
      ++corners;
    }
    if (corners < 3) fail("the face has " + std::to_string(corners) + " corners, expected at least 3");
  }

  static std::size_t at(std::int64_t index) { return static_cast<std::size_t>(index); }

  RawMesh mesh_;
  std::size_t line_number_ = 0;
  std::vector<Vec3f> positions_, normals_;  // as listed in the file
  std::vector<Vec2f> uvs_;
  std::vector<Corner> corners_;             // one per vertex of mesh_
  std::vector<std::int64_t> first_vertex_;  // for each listed position, or -1
  bool has_uvs_ = false, has_normals_ = false;
};

}  // namespace

RawMesh parse_obj(const std::string& text, const std::string& name) {
  ObjParser parser(name);
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    parser.parse_line(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return parser.result();
}

}  // namespace fluxfarm
