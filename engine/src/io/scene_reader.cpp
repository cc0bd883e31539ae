#include "io/scene_reader.h"

#include "io/mitsuba_json.h"
#include "io/properties.h"
#include "io/read_emitter.h"
#include "io/read_gltf.h"
#include "io/read_sensor.h"
#include "io/read_shape.h"
#include "io/scene_light.h"
#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

void check_no_overrides(const std::string& name, const SceneOverrides& overrides) {
  if (!overrides.empty())
    throw SceneError(name, "takes no value for $" + overrides.begin()->first + ": only XML scenes have such names");
}

PluginNode read_tree(const Bundle& bundle, const SceneOverrides& overrides) {
  const std::string extension = bundle.entry().extension().string();
  if (extension == ".xml") return read_mitsuba_xml(bundle, overrides);
  const std::string name = bundle.name(bundle.entry());
  if (extension != ".json")
    throw SceneError(name, "has the extension " + in_quotes(extension) + ", expected .xml, .json, .glb or .gltf");
  check_no_overrides(name, overrides);
  return read_mitsuba_json(bundle);
}

// Materials and textures that no shape uses must be right, too, but they are no part of the description, and images stay closed.
void check_unused(const PluginNode& scene, const PluginsById& plugins, const Bundle& bundle, const MaterialReader& used_materials,
                  const TextureReader& used_textures) {
  std::vector<MaterialDescription> materials;
  std::vector<TextureDescription> textures;
  TextureReader texture_reader(plugins, bundle, TextureReader::Images::kCheckOnly, textures);
  MaterialReader material_reader(plugins, texture_reader, materials);
  for (const PluginNode& child : scene.children) {
    if (child.kind == PluginKind::kBsdf && !used_materials.has_read(child)) material_reader.read(child);
    if (child.kind == PluginKind::kTexture && !used_textures.has_read(child)) texture_reader.read(child);
  }
}

// A medium that nothing refers to would silently be nowhere. A phase function must be right, used or not.
void check_media_used(const PluginNode& scene, const MediumReader& media) {
  for (const PluginNode& child : scene.children) {
    if (child.kind == PluginKind::kPhase) read_phase(child);
    if (child.kind == PluginKind::kMedium && !media.has_read(child)) {
      throw SceneError(child.place, title(child) + " fills nothing, expected a shape or the sensor that refers to it" +
                                        (child.id.empty() ? "; it needs an id for that" : ""));
    }
  }
}

// Without a texture that shows them, the colours of meshes are not kept.
void drop_unused_colors(SceneDescription& scene) {
  const auto shows_colors = [](const TextureDescription& t) { return std::holds_alternative<MeshAttributeDescription>(t); };
  if (std::any_of(scene.textures.begin(), scene.textures.end(), shows_colors)) return;
  for (ShapeDescription& shape : scene.shapes) {
    if (auto* mesh = std::get_if<MeshDescription>(&shape.geometry)) mesh->colors = {};
  }
}

SceneDescription build(const PluginNode& root, const Bundle& bundle) {
  SceneDescription scene;
  Properties(root).finish();
  const PluginsById plugins = plugins_by_id(root);
  TextureReader textures(plugins, bundle, TextureReader::Images::kRead, scene.textures);
  MaterialReader materials(plugins, textures, scene.materials);
  MediumReader media(plugins, scene.media);
  const PluginNode* sensor = nullptr;
  const PluginNode* integrator = nullptr;
  const PluginNode* envmap = nullptr;
  for (const PluginNode& child : root.children) {
    switch (child.kind) {
      case PluginKind::kShape:
        if (child.type == "gltf") {
          read_gltf_node(child, bundle, scene);
        } else {
          scene.shapes.push_back(read_shape(child, bundle, materials, media, scene.warnings));
        }
        break;
      case PluginKind::kEmitter:
        if (child.type == "envmap" && envmap)
          throw SceneError(child.place, "the scene has a second envmap; the first is at " + envmap->place);
        if (child.type == "envmap") envmap = &child;
        scene.emitters.push_back(read_scene_emitter(child, bundle));
        break;
      case PluginKind::kBsdf:
      case PluginKind::kTexture:
      case PluginKind::kMedium:
      case PluginKind::kPhase: break;  // read when something refers to it
      case PluginKind::kSensor:
        if (sensor)
          scene.warnings.push_back(child.place + ": the scene has more than one sensor; the one at " + sensor->place + " is used");
        if (!sensor) sensor = &child;
        break;
      case PluginKind::kIntegrator:
        if (integrator) throw SceneError(child.place, "the scene has a second integrator; the first is at " + integrator->place);
        integrator = &child;
        break;
      default: fail_nested(root, child, "integrator, sensor, bsdf, texture, medium, phase, shape and emitter");
    }
  }
  drop_unused_colors(scene);
  check_unused(root, plugins, bundle, materials, textures);
  if (!sensor) throw SceneError(root.place, "the scene has no sensor, expected one, as in <sensor type=\"perspective\">");
  read_sensor(*sensor, media, scene);
  check_media_used(root, media);
  if (integrator) scene.method = read_integrator(*integrator);
  if (!has_light(scene)) scene.warnings.push_back(root.place + ": no light: the image will be black");
  return scene;
}

}  // namespace

SceneDescription read_scene(const std::filesystem::path& folder, const std::filesystem::path& entry,
                            const SceneOverrides& overrides) {
  const Bundle bundle(folder, entry);
  const std::string extension = bundle.entry().extension().string();
  if (extension == ".glb" || extension == ".gltf") {
    check_no_overrides(bundle.name(bundle.entry()), overrides);
    return read_gltf_scene(bundle);
  }
  return build(read_tree(bundle, overrides), bundle);
}

}  // namespace fluxfarm
