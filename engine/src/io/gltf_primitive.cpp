#include "io/gltf_primitive.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "io/gltf_accessor.h"
#include "io/limits.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

constexpr std::uint64_t kTriangles = 4, kStrip = 5, kFan = 6;

std::vector<Vec3f> as_vectors(const std::vector<float>& values) {
  std::vector<Vec3f> result(values.size() / 3);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  return result;
}

std::vector<Vec2f> as_pairs(const std::vector<float>& values) {
  std::vector<Vec2f> result(values.size() / 2);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = {values[2 * i], values[2 * i + 1]};
  return result;
}

// Triangles in the order that the specification gives, all running the same way.                        [glTF, 3.7.2.1]
std::vector<std::uint32_t> triangles_of(const std::vector<std::uint32_t>& indices, std::uint64_t mode) {
  if (mode == kTriangles) return indices;
  std::vector<std::uint32_t> result;
  for (std::size_t i = 0; i + 2 < indices.size(); ++i) {
    if (mode == kStrip) {
      result.insert(result.end(), {indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]});
    } else {
      result.insert(result.end(), {indices[i + 1], indices[i + 2], indices[0]});
    }
  }
  return result;
}

class PrimitiveReader {
 public:
  PrimitiveReader(GltfFile& file, const GltfObject& primitive, GltfMeshBudget& budget)
      : file_(file), primitive_(primitive), attributes_(primitive.required_object("attributes")), budget_(budget) {}

  std::optional<std::size_t> accessor(const std::string& attribute) const {
    return attributes_.index(attribute.c_str(), "accessors", file_.size("accessors"));
  }

  std::vector<float> attribute(const std::string& name, std::size_t components) {
    const auto index = accessor(name);
    if (!index) return {};
    take(accessor_count(file_, *index));
    std::vector<float> values = read_floats(file_, *index, components);
    if (vertices_ == 0) vertices_ = values.size() / components;
    if (values.size() / components != vertices_) {
      attributes_.fail(name.c_str(), "with " + std::to_string(values.size() / components) +
                                         " elements, expected as many as POSITION has: " + std::to_string(vertices_));
    }
    return values;
  }

  // COLOR_0 without alpha; `has_alpha` is set where that is below 1. Clamped as the specification says.   [glTF, 3.7.2.1]
  std::vector<Rgb> colors(bool& has_alpha) {
    const auto index = accessor("COLOR_0");
    if (!index) return {};
    const GltfObject object = file_.at("accessors", *index);
    const std::string type = object.text("type", "");
    if (type != "VEC3" && type != "VEC4") object.fail("type", "expected \"VEC3\" or \"VEC4\"");
    const bool is_float = object.required_count("componentType", 65535) == 5126;
    if (!is_float && !object.boolean("normalized", false)) object.fail("normalized", "expected true for colours as integers");
    const std::size_t components = type == "VEC3" ? 3 : 4;
    const std::vector<float> values = attribute("COLOR_0", components);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (std::isnan(values[i]))
        attributes_.fail("COLOR_0", "whose vertex " + std::to_string(i / components) + " has a value that is not a number");
    }
    std::vector<Rgb> result(values.size() / components);
    for (std::size_t i = 0; i < result.size(); ++i) {
      const float* v = values.data() + i * components;
      result[i] = {std::clamp(v[0], 0.0f, 1.0f), std::clamp(v[1], 0.0f, 1.0f), std::clamp(v[2], 0.0f, 1.0f)};
      has_alpha |= components == 4 && v[3] < 1;
    }
    return result;
  }

  std::vector<std::uint32_t> indices() {
    const auto index = primitive_.index("indices", "accessors", file_.size("accessors"));
    if (index) {
      take(accessor_count(file_, *index));
      return read_indices(file_, *index);
    }
    std::vector<std::uint32_t> all(vertices_);
    std::iota(all.begin(), all.end(), 0u);
    return all;
  }

 private:
  void take(std::uint64_t elements) {
    budget_.elements += elements;
    if (budget_.elements > kMaxAccessorElements) {
      throw SceneError(primitive_.place(), "with this one the meshes have " + std::to_string(budget_.elements) +
                                               " vertices and indices, expected at most " + std::to_string(kMaxAccessorElements));
    }
  }

  GltfFile& file_;
  const GltfObject& primitive_;
  GltfObject attributes_;
  GltfMeshBudget& budget_;
  std::size_t vertices_ = 0;
};

}  // namespace

std::optional<GltfPrimitive> read_gltf_primitive(GltfFile& file, const GltfObject& primitive, int uv_set, GltfMeshBudget& budget,
                                                 std::vector<std::string>& warnings) {
  const std::uint64_t mode = primitive.count("mode", 6).value_or(kTriangles);
  if (mode < kTriangles) {
    warnings.push_back(primitive.place() + ": points and lines are not drawn");
    return std::nullopt;
  }
  PrimitiveReader reader(file, primitive, budget);
  if (!reader.accessor("POSITION")) {
    warnings.push_back(primitive.place() + ": has no POSITION and is not drawn");
    return std::nullopt;
  }
  if (primitive.has("targets")) warnings.push_back(primitive.place() + ": morph targets are not read; the mesh stands as it is");
  GltfPrimitive result;
  result.mesh.name = primitive.place();
  result.mesh.positions = as_vectors(reader.attribute("POSITION", 3));
  result.mesh.normals = as_vectors(reader.attribute("NORMAL", 3));
  result.mesh.uvs = as_pairs(reader.attribute("TEXCOORD_" + std::to_string(uv_set), 2));
  result.mesh.colors = reader.colors(result.has_alpha);
  result.face_normals = result.mesh.normals.empty();
  const std::vector<std::uint32_t> indices = reader.indices();
  if (mode == kTriangles && indices.size() % 3 != 0)
    throw SceneError(primitive.place(), "has " + std::to_string(indices.size()) + " corners, expected a multiple of three");
  result.mesh.indices = triangles_of(indices, mode);
  return result;
}

}  // namespace fluxfarm
