#include "io/gltf_nodes.h"

#include <cmath>

#include "io/gltf_accessor.h"
#include "io/limits.h"
#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

// Rotation by the quaternion x, y, z, w, which need not have unit length; nothing if it is zero.
std::optional<Transform> quaternion_rotation(double x, double y, double z, double w) {
  const double squared = x * x + y * y + z * z + w * w;
  if (!(squared > 0) || !std::isfinite(squared)) return std::nullopt;
  const double s = 2 / squared;
  return Transform(Transform::Matrix{{{1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w), 0},
                                      {s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w), 0},
                                      {s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y), 0},
                                      {0, 0, 0, 1}}});
}

Transform read_matrix(const GltfObject& node) {
  const std::vector<double> columns = node.numbers("matrix", 16, {});
  Transform::Matrix m;
  for (std::size_t i = 0; i < 16; ++i) m[i % 4][i / 4] = columns[i];
  if (m[3] != std::array<double, 4>{0, 0, 0, 1}) node.fail("matrix", "expected 0, 0, 0, 1 as the last row: an affine map");
  return Transform(m);
}

Transform local_transform(const GltfObject& node) {
  if (node.has("matrix")) {
    for (const char* name : {"translation", "rotation", "scale"})
      if (node.has(name)) node.fail(name, "but a matrix is given, too; expected one or the other");
    return read_matrix(node);
  }
  const std::vector<double> t = node.numbers("translation", 3, {0, 0, 0}), r = node.numbers("rotation", 4, {0, 0, 0, 1}),
                            s = node.numbers("scale", 3, {1, 1, 1});
  const std::optional<Transform> rotation = quaternion_rotation(r[0], r[1], r[2], r[3]);
  if (!rotation) node.fail("rotation", "expected a quaternion other than 0");
  return Transform::translate(t[0], t[1], t[2]) * *rotation * Transform::scale(s[0], s[1], s[2]);
}

class NodeWalk {
 public:
  NodeWalk(GltfFile& file, std::vector<std::string>& warnings)
      : file_(file), warnings_(warnings), reached_(file.size("nodes"), false) {}

  GltfNodes walk(const Transform& to_world) {
    for (const std::size_t root : roots()) push(root, to_world, 1);
    // A stack of our own: the depth is the file's choice.
    while (!waiting_.empty()) {
      const Waiting next = waiting_.back();
      waiting_.pop_back();
      visit(next);
    }
    return std::move(result_);
  }

 private:
  struct Waiting {
    std::size_t node = 0;
    Transform parent;
    std::size_t depth = 0;
  };

  std::vector<std::size_t> roots() const {
    const std::size_t nodes = file_.size("nodes");
    if (file_.size("scenes") > 0) {
      const std::size_t scene = file_.root().index("scene", "scenes", file_.size("scenes")).value_or(0);
      return reversed(file_.at("scenes", scene).indices("nodes", "nodes", nodes));
    }
    std::vector<bool> is_child(nodes, false);
    for (std::size_t i = 0; i < nodes; ++i)
      for (const std::size_t child : file_.at("nodes", i).indices("children", "nodes", nodes)) is_child[child] = true;
    std::vector<std::size_t> result;
    for (std::size_t i = nodes; i-- > 0;)
      if (!is_child[i]) result.push_back(i);
    return result;
  }

  // What is pushed last is visited first.
  static std::vector<std::size_t> reversed(std::vector<std::size_t> indices) { return {indices.rbegin(), indices.rend()}; }

  void push(std::size_t node, const Transform& parent, std::size_t depth) {
    const std::string place = file_.name() + ": nodes[" + std::to_string(node) + "]";
    if (reached_[node]) throw SceneError(place, "is reached twice: it has two parents or lies on a cycle, expected a tree");
    if (depth > kMaxNodeDepth) throw SceneError(place, "lies more than " + std::to_string(kMaxNodeDepth) + " nodes deep");
    reached_[node] = true;
    waiting_.push_back({node, parent, depth});
  }

  void visit(const Waiting& waiting) {
    const GltfObject node = file_.at("nodes", waiting.node);
    const Transform to_world = waiting.parent * local_transform(node);
    if (!to_world.is_finite()) throw SceneError(node.place(), "the transform to the world is not finite");
    const std::string name = node.has("name") ? node.place() + " " + in_quotes(node.text("name", "")) : node.place();
    if (const auto mesh = node.index("mesh", "meshes", file_.size("meshes"))) place_mesh(node, {*mesh, to_world, name});
    if (const auto camera = node.index("camera", "cameras", file_.size("cameras")))
      result_.cameras.push_back({*camera, to_world, name});
    if (const auto extension = node.extension("KHR_lights_punctual")) {
      const auto lights = file_.root().extension("KHR_lights_punctual");
      const std::size_t size = lights ? lights->objects("lights").size() : 0;
      result_.lights.push_back({extension->required_index("light", "lights", size), to_world, name});
    }
    for (const std::size_t child : reversed(node.indices("children", "nodes", file_.size("nodes"))))
      push(child, to_world, waiting.depth + 1);
  }

  void place_mesh(const GltfObject& node, const GltfPlaced& placed) {
    if (node.has("skin")) warnings_.push_back(placed.name + ": skins are not read; the mesh stands as it is");
    const auto instancing = node.extension("EXT_mesh_gpu_instancing");
    if (!instancing) return add(placed);
    const GltfObject attributes = instancing->required_object("attributes");
    std::optional<std::uint64_t> count;
    for (const char* name : {"TRANSLATION", "ROTATION", "SCALE"}) {
      const auto accessor = attributes.index(name, "accessors", file_.size("accessors"));
      if (!accessor) continue;
      const std::uint64_t own = accessor_count(file_, *accessor);
      if (count && *count != own)
        attributes.fail(
            name, "with " + std::to_string(own) + " elements, expected as many as the others have: " + std::to_string(*count));
      count = own;
    }
    if (!count) throw SceneError(attributes.place(), "has none of TRANSLATION, ROTATION and SCALE, expected one of them");
    if (*count > kMaxPlacedMeshes) {
      throw SceneError(attributes.place(), "places " + std::to_string(*count) + " instances, expected at most " +
                                               std::to_string(kMaxPlacedMeshes) + " meshes in a file");
    }
    add_instances(attributes, placed, *count);
  }

  void add_instances(const GltfObject& attributes, const GltfPlaced& placed, std::size_t count) {
    const auto read = [&](const char* name, std::size_t components) -> std::vector<float> {
      const auto accessor = attributes.index(name, "accessors", file_.size("accessors"));
      return accessor ? read_floats(file_, *accessor, components) : std::vector<float>{};
    };
    const std::vector<float> t = read("TRANSLATION", 3), r = read("ROTATION", 4), s = read("SCALE", 3);
    const auto value = [](const std::vector<float>& values, std::size_t i) { return static_cast<double>(values[i]); };
    for (std::size_t i = 0; i < count; ++i) {
      const std::string name = placed.name + " instance " + std::to_string(i);
      Transform own;
      if (!t.empty()) own = Transform::translate(value(t, 3 * i), value(t, 3 * i + 1), value(t, 3 * i + 2));
      if (!r.empty()) {
        const auto rotation = quaternion_rotation(value(r, 4 * i), value(r, 4 * i + 1), value(r, 4 * i + 2), value(r, 4 * i + 3));
        if (!rotation) throw SceneError(name, "has the rotation 0, expected a quaternion other than 0");
        own = own * *rotation;
      }
      if (!s.empty()) own = own * Transform::scale(value(s, 3 * i), value(s, 3 * i + 1), value(s, 3 * i + 2));
      const Transform to_world = placed.to_world * own;
      if (!to_world.is_finite()) throw SceneError(name, "the transform to the world is not finite");
      add({placed.index, to_world, name});
    }
  }

  void add(GltfPlaced placed) {
    if (result_.meshes.size() >= kMaxPlacedMeshes) {
      throw SceneError(placed.name, "with this one the file places more than " + std::to_string(kMaxPlacedMeshes) +
                                        " meshes, which is the limit");
    }
    result_.meshes.push_back(std::move(placed));
  }

  GltfFile& file_;
  std::vector<std::string>& warnings_;
  std::vector<bool> reached_;
  std::vector<Waiting> waiting_;
  GltfNodes result_;
};

}  // namespace

GltfNodes read_gltf_nodes(GltfFile& file, const Transform& to_world, std::vector<std::string>& warnings) {
  return NodeWalk(file, warnings).walk(to_world);
}

}  // namespace fluxfarm
