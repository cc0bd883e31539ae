#include "io/read_gltf.h"

#include <algorithm>
#include <cmath>

#include "io/gltf_camera.h"
#include "io/gltf_lights.h"
#include "io/gltf_material.h"
#include "io/gltf_nodes.h"
#include "io/gltf_primitive.h"
#include "io/limits.h"
#include "io/mesh_checks.h"
#include "io/properties.h"
#include "io/scene_light.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

// Whether everything shrinks to a line or a point: no triangle keeps an area.
bool has_no_area(const Transform& transform) {
  return transform.normal({1, 0, 0}) == Vec3f{} && transform.normal({0, 1, 0}) == Vec3f{} && transform.normal({0, 0, 1}) == Vec3f{};
}

bool is_invertible(const Transform& transform) {
  const double determinant = transform.determinant();
  return std::isnormal(static_cast<float>(determinant));
}

// Brings the meshes of a file into a scene: once for all places that share them, or as a copy where each needs its own.
class MeshPlacer {
 public:
  MeshPlacer(GltfFile& file, GltfMaterials& materials, SceneDescription& scene)
      : file_(file), materials_(materials), scene_(scene) {}

  void place(const std::vector<GltfPlaced>& meshes) {
    std::vector<std::size_t> uses(file_.size("meshes"), 0);
    for (const GltfPlaced& placed : meshes) ++uses[placed.index];
    for (const GltfPlaced& placed : meshes) place(placed, uses[placed.index] > 1);
  }

 private:
  struct Primitive {
    GltfObject object;
    GltfMaterial material;
    std::shared_ptr<const MeshDescription> shared;  // made for the first instance
    bool is_drawn = true;
  };

  std::vector<Primitive>& primitives_of(std::size_t mesh) {
    std::vector<Primitive>& primitives = primitives_[mesh];
    if (!primitives.empty()) return primitives;
    const GltfObject object = file_.at("meshes", mesh);
    for (GltfObject& primitive : object.objects("primitives")) {
      const GltfMaterial material = materials_.of_primitive(primitive);
      primitives.push_back({std::move(primitive), material, nullptr});
    }
    if (primitives.empty()) object.fail("primitives", "expected at least one");
    return primitives;
  }

  void place(const GltfPlaced& placed, bool is_shared) {
    if (has_no_area(placed.to_world)) {
      scene_.warnings.push_back(placed.name + ": is scaled to nothing and left out");
      return;
    }
    std::vector<Primitive>& primitives = primitives_of(placed.index);
    if (scene_.shapes.size() + primitives.size() > kMaxPlacedMeshes) {
      throw SceneError(placed.name, "with this one the scene has more than " + std::to_string(kMaxPlacedMeshes) + " shapes");
    }
    for (Primitive& primitive : primitives) {
      if (!primitive.is_drawn) continue;
      // A light has a mesh of its own, as has what is squashed flat: neither could be an instance.
      const bool instance = is_shared && !primitive.material.emitted_radiance && is_invertible(placed.to_world);
      place(placed, primitive, instance);
    }
  }

  void place(const GltfPlaced& placed, Primitive& primitive, bool instance) {
    ShapeDescription shape;
    shape.name = placed.name;
    shape.material = primitive.material.index;
    shape.emitted_radiance = primitive.material.emitted_radiance;
    shape.emits_on_both_sides = primitive.material.double_sided;
    shape.interior_medium = primitive.material.interior_medium;
    if (instance) {
      if (!primitive.shared) {
        std::optional<MeshDescription> mesh = read(primitive, Transform());
        if (!mesh) return;
        primitive.shared = std::make_shared<const MeshDescription>(std::move(*mesh));
      }
      shape.geometry = InstanceDescription{primitive.shared, placed.to_world};
    } else {
      std::optional<MeshDescription> mesh = read(primitive, placed.to_world);
      if (!mesh) return;
      shape.geometry = std::move(*mesh);
    }
    scene_.shapes.push_back(std::move(shape));
  }

  // Nothing for what is not drawn, which is said once.
  std::optional<MeshDescription> read(Primitive& primitive, const Transform& to_world) {
    std::optional<GltfPrimitive> raw =
        read_gltf_primitive(file_, primitive.object, primitive.material.uv_set, budget_, scene_.warnings);
    primitive.is_drawn = raw.has_value();
    if (!raw) return std::nullopt;
    if (raw->has_alpha && primitive.material.has_alpha)
      scene_.warnings.push_back(primitive.object.place() + ": COLOR_0: alpha of vertices is not read");
    // Where the corners decide which side is the front, a mirroring node turns their order around.            [glTF, 3.7.4]
    if (raw->face_normals && to_world.determinant() < 0) {
      for (std::size_t i = 0; i + 2 < raw->mesh.indices.size(); i += 3)
        std::swap(raw->mesh.indices[i + 1], raw->mesh.indices[i + 2]);
    }
    MeshOptions options;
    options.to_world = to_world;
    options.face_normals = raw->face_normals;
    return finish_mesh(std::move(raw->mesh), options, scene_.warnings);
  }

  GltfFile& file_;
  GltfMaterials& materials_;
  SceneDescription& scene_;
  GltfMeshBudget budget_;
  std::map<std::size_t, std::vector<Primitive>> primitives_;
};

// Adds shapes and lights; returns what the cameras need.
GltfNodes read_into(GltfFile& file, const Transform& to_world, SceneDescription& scene) {
  GltfNodes nodes = read_gltf_nodes(file, to_world, scene.warnings);
  GltfTextures textures(file, scene.textures, scene.warnings);
  GltfMaterials materials(file, textures, scene);
  MeshPlacer(file, materials, scene).place(nodes.meshes);
  for (const GltfPlaced& light : nodes.lights) scene.emitters.push_back(read_gltf_light(file, light));
  if (file.size("animations") > 0) scene.warnings.push_back(file.name() + ": animations are not read; nothing moves");
  return nodes;
}

// Of all corners, and of the corners' boxes of instances.
Bounds bounds_of(const SceneDescription& scene) {
  Bounds bounds;
  std::map<const MeshDescription*, Bounds> shared;
  for (const ShapeDescription& shape : scene.shapes) {
    if (const auto* mesh = std::get_if<MeshDescription>(&shape.geometry)) {
      for (const Vec3f& p : mesh->positions) bounds.extend(p);
    } else if (const auto* instance = std::get_if<InstanceDescription>(&shape.geometry)) {
      Bounds& own = shared[instance->mesh.get()];
      if (own.empty())
        for (const Vec3f& p : instance->mesh->positions) own.extend(p);
      for (int i = 0; i < 8; ++i) {
        const Vec3f corner{(i & 1) != 0 ? own.upper.x : own.lower.x, (i & 2) != 0 ? own.upper.y : own.lower.y,
                           (i & 4) != 0 ? own.upper.z : own.lower.z};
        bounds.extend(instance->to_world.point(corner));
      }
    }
  }
  return bounds;
}

}  // namespace

SceneDescription read_gltf_scene(const Bundle& bundle) {
  SceneDescription scene;
  GltfFile file(bundle, bundle.entry(), scene.warnings);
  const GltfNodes nodes = read_into(file, Transform(), scene);
  if (scene.shapes.empty()) throw SceneError(file.name(), "has no mesh to show, expected at least one in its scene");
  read_gltf_camera(file, nodes.cameras, bounds_of(scene), scene);
  if (!has_light(scene)) {
    scene.emitters.emplace_back(ConstantEmitterDescription{Rgb(1)});
    scene.warnings.push_back(file.name() + ": no light: a constant white environment of radiance 1 lights the scene");
  }
  return scene;
}

void read_gltf_node(const PluginNode& node, const Bundle& bundle, SceneDescription& scene) {
  check_no_children(node);
  Properties properties(node);
  const Transform to_world = properties.transform("to_world");
  if (!properties.has("filename")) properties.fail("filename", "lacks the parameter \"filename\"");
  const std::filesystem::path path = bundle.find(properties.text("filename", ""), node.place);
  properties.finish();
  GltfFile file(bundle, path, scene.warnings);
  read_into(file, to_world, scene);
}

}  // namespace fluxfarm
