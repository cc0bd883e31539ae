#include "io/read_shape.h"

#include <cmath>

#include "io/limits.h"
#include "io/mesh_checks.h"
#include "io/mesh_obj.h"
#include "io/mesh_ply.h"
#include "io/properties.h"
#include "io/read_emitter.h"
#include "io/text.h"
#include "io/transform_checks.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

Vec3f unit_axis(const Transform& transform, std::size_t j) {
  const auto& m = transform.matrix();
  const double scale = axis_scale(transform, j);
  return {static_cast<float>(m[0][j] / scale), static_cast<float>(m[1][j] / scale), static_cast<float>(m[2][j] / scale)};
}

// Texture coordinates on a side of the cube, as in Mitsuba: each side shows the whole unit square.
Vec2f cube_uv(int axis, bool positive, Vec3f p) {
  const Vec2f st = axis == 0   ? (positive ? Vec2f{p.y, -p.z} : Vec2f{p.y, p.z})
                   : axis == 1 ? (positive ? Vec2f{-p.x, -p.z} : Vec2f{p.z, p.x})
                               : (positive ? Vec2f{p.y, p.x} : Vec2f{-p.y, p.x});
  return {(st.x + 1) / 2, (st.y + 1) / 2};
}

// [-1,1]^3 with four vertices a side, so that normals and texture coordinates are those of the sides.
RawMesh cube_mesh() {
  RawMesh mesh;
  mesh.name = "cube";
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const Vec2f corner : {Vec2f{0, 0}, Vec2f{1, 0}, Vec2f{1, 1}, Vec2f{0, 1}}) {
        // The two other axes in an order that makes the corners run counter-clockwise as seen from outside.
        const float s = 2 * corner.x - 1, t = side * (2 * corner.y - 1);
        mesh.positions.push_back(axis == 0 ? Vec3f{side, s, t} : axis == 1 ? Vec3f{t, side, s} : Vec3f{s, t, side});
        mesh.normals.push_back(axis == 0 ? Vec3f{side, 0, 0} : axis == 1 ? Vec3f{0, side, 0} : Vec3f{0, 0, side});
        mesh.uvs.push_back(cube_uv(axis, side > 0, mesh.positions.back()));
      }
      mesh.indices.insert(mesh.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
    }
  }
  return mesh;
}

RawMesh read_mesh_file(const PluginNode& node, Properties& properties, const Bundle& bundle) {
  if (!properties.has("filename")) properties.fail("filename", "lacks the parameter \"filename\"");
  const std::string filename = properties.text("filename", "");
  const std::string& place = node.place;
  const std::filesystem::path file = bundle.find(filename, place);
  const std::string name = bundle.name(file);
  const std::string bytes = read_file(file, name, kMaxMeshFileBytes);
  return node.type == "obj" ? parse_obj(bytes, name) : parse_ply(bytes, name);
}

MeshDescription read_mesh(const PluginNode& node, Properties& properties, const Bundle& bundle,
                          std::vector<std::string>& warnings) {
  MeshOptions options;
  options.to_world = properties.transform("to_world");
  options.face_normals = properties.boolean("face_normals", false);
  // The defaults are Mitsuba's: OBJ counts v from the bottom.
  if (node.type != "cube") options.flip_tex_coords = properties.boolean("flip_tex_coords", node.type == "obj");
  RawMesh raw = node.type == "cube" ? cube_mesh() : read_mesh_file(node, properties, bundle);
  if (node.type == "cube") raw.name = node.place + ": cube";
  return finish_mesh(std::move(raw), options, warnings);
}

SphereDescription read_sphere(Properties& properties, bool& flip_normals) {
  const Transform to_world = properties.transform("to_world");
  if (!keeps_shape(to_world, 3))
    properties.fail("to_world", "stretches or shears the sphere, expected the same scale, not 0, on all axes");
  // Mitsuba turns a mirrored sphere inside out; so do we.
  if (to_world.determinant() < 0) flip_normals = !flip_normals;
  const Triple c = properties.triple("center", {0, 0, 0});
  SphereDescription sphere;
  sphere.center = to_world.point({static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])});
  sphere.radius = properties.number("radius", 1, kPositive) * static_cast<float>(axis_scale(to_world, 0));
  sphere.axes.s = unit_axis(to_world, 0);
  sphere.axes.t = unit_axis(to_world, 1);
  sphere.axes.n = unit_axis(to_world, 2);
  if (!is_finite(sphere.center)) properties.fail("center", "expected finite numbers");
  if (!(sphere.radius > 0) || !std::isfinite(sphere.radius))
    properties.fail("radius", "with to_world the radius becomes 0 or infinite");
  return sphere;
}

DiskDescription read_disk(Properties& properties) {
  const Transform to_world = properties.transform("to_world");
  if (!keeps_shape(to_world, 2))
    properties.fail("to_world", "makes the disk an ellipse or a point, expected the same scale, not 0, on x and y");
  return {to_world};
}

RectangleDescription read_rectangle(Properties& properties) {
  const Transform to_world = properties.transform("to_world");
  const Vec3f normal = to_world.normal({0, 0, 1});
  if (!is_finite(normal) || normal == Vec3f{})
    properties.fail("to_world", "gives the rectangle no area, expected x and y axes that differ and are not 0");
  return {to_world};
}

void read_medium_of(const PluginNode& node, const PluginNode& child, MediumReader& media, ShapeDescription& shape) {
  if (child.name != "interior" && child.name != "exterior") {
    throw SceneError(child.place, title(node) + " holds a " + title(child) + " named " + in_quotes(child.name) +
                                      ", expected the name interior or exterior");
  }
  int& side = child.name == "interior" ? shape.interior_medium : shape.exterior_medium;
  if (side != kNoMedium) throw SceneError(child.place, title(node) + " has a second medium named " + in_quotes(child.name));
  side = media.read(child);
}

// The bsdf, the emitter and the media inside the shape.
void read_nested(const PluginNode& node, MaterialReader& materials, MediumReader& media, ShapeDescription& shape) {
  bool has_material = false;
  for (const PluginNode& child : node.children) {
    if (is_medium_of_shape(child)) {
      read_medium_of(node, child, media, shape);
    } else if (child.kind == PluginKind::kBsdf || child.kind == PluginKind::kReference) {
      if (has_material) fail_nested(node, child, "one bsdf");
      shape.material = materials.read(child);
      has_material = true;
    } else if (child.kind == PluginKind::kEmitter) {
      if (shape.emitted_radiance) fail_nested(node, child, "one emitter");
      shape.emitted_radiance = read_area_emitter(child, node);
    } else {
      fail_nested(node, child, "one bsdf, one emitter and two media");
    }
  }
  // As in Mitsuba: grey, or black if the shape is a light.
  if (!has_material) shape.material = materials.diffuse(shape.emitted_radiance ? 0.0f : 0.5f);
}

}  // namespace

ShapeDescription read_shape(const PluginNode& node, const Bundle& bundle, MaterialReader& materials, MediumReader& media,
                            std::vector<std::string>& warnings) {
  Properties properties(node);
  ShapeDescription shape;
  shape.name = node.id.empty() ? node.place : node.id;
  shape.flip_normals = properties.boolean("flip_normals", false);
  if (node.type == "sphere") {
    shape.geometry = read_sphere(properties, shape.flip_normals);
  } else if (node.type == "disk") {
    shape.geometry = read_disk(properties);
  } else if (node.type == "rectangle") {
    shape.geometry = read_rectangle(properties);
  } else {
    shape.geometry = read_mesh(node, properties, bundle, warnings);
  }
  properties.finish();
  read_nested(node, materials, media, shape);
  return shape;
}

}  // namespace fluxfarm
