#include "scene/scene.h"

#include <algorithm>
#include <sstream>
#include <unordered_set>

#include "materials/make_bsdf.h"
#include "materials/make_textured.h"
#include "scene/make_emitter.h"
#include "scene/make_shape.h"
#include "scene/material_needs.h"
#include "scene/working_frame.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

void check_colors(const std::string& shape, const std::vector<Rgb>& colors) {
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const Rgb c = colors[i];
    for (const float channel : {c.r, c.g, c.b}) {
      if (channel >= 0 && channel <= 1) continue;
      throw SceneError(shape, "vertex_color of vertex " + std::to_string(i) + " has the value " + std::to_string(channel) +
                                  ", expected numbers from 0 to 1");
    }
  }
}

bool is_null(const MaterialDescription& material) { return std::holds_alternative<NullDescription>(material); }

Bounds bounds_of(const std::vector<Scene::Surface>& surfaces) {
  Bounds bounds;
  for (const Scene::Surface& surface : surfaces) {
    const Bounds own = surface.shape->bounds();
    bounds.extend(own.lower);
    bounds.extend(own.upper);
  }
  return bounds;
}

// Coordinates at most, m. Embree ends the program where a ray starts beyond 1.8e18, and rays from outside start a few times as far
// away as the scene reaches.
constexpr float kReach = 1e17f;

void check_reach(const std::string& what, Vec3f place) {
  const float distance = std::max({std::fabs(place.x), std::fabs(place.y), std::fabs(place.z)});
  if (distance <= kReach) return;
  std::ostringstream message;
  message << "is " << distance << " m from the origin, expected at most " << kReach;
  throw SceneError(what, message.str());
}

void check_reach(const CameraDescription& camera, Vec3f position) {
  const float lens = camera.near_clip + camera.aperture_radius;  // rays start so far from there
  check_reach("the sensor", {std::fabs(position.x) + lens, std::fabs(position.y) + lens, std::fabs(position.z) + lens});
}

void check_reach(const EmitterDescription& emitter) {
  if (const auto* point = std::get_if<PointEmitterDescription>(&emitter)) check_reach("a point emitter", point->position);
  if (const auto* spot = std::get_if<SpotEmitterDescription>(&emitter)) check_reach("a spot emitter", spot->position);
}

}  // namespace

Scene::Scene(const SceneDescription& description, int threads) : Scene(WorkingDescription(description), threads) {}

Scene::Scene(const WorkingDescription& working, int threads)
    : film_(working.get().film),
      method_(working.get().method),
      pixel_filter_(working.get().film.filter),
      camera_(working.get().camera, working.get().film.width, working.get().film.height),
      bsdfs_(make_bsdfs(working.get().materials)),
      textures_(make_textures(working.get().textures)),
      textured_materials_(make_textured_materials(working.get().materials, bsdfs_, textures_)),
      media_(working.get().media.begin(), working.get().media.end()),
      camera_medium_(medium(working.get().camera.medium)),
      accelerator_(std::make_unique<RayAccelerator>(threads)),
      warnings_(working.get().warnings) {
  const SceneDescription& description = working.get();
  warnings_.insert(warnings_.end(), working.warnings().begin(), working.warnings().end());
  census_.materials = bsdfs_.size();
  census_.textures = textures_.size();
  census_.media = media_.size();
  census_.coloured_media = std::any_of(media_.begin(), media_.end(), [](const HomogeneousMedium& m) { return m.coloured(); });
  check_reach(description.camera, camera_.position());
  surfaces_.reserve(description.shapes.size());
  std::unordered_set<const TriangleMesh*> counted;  // of those that instances share
  for (const ShapeDescription& shape : description.shapes) {
    Surface surface;
    surface.shape = add_shape(shape, shape.emitted_radiance.has_value(), shared_meshes_, *accelerator_);
    const Bounds bounds = surface.shape->bounds();
    for (const Vec3f corner : {bounds.lower, bounds.upper}) check_reach(shape.name, corner);
    const Bsdf* bsdf = bsdfs_[static_cast<std::size_t>(shape.material)].get();
    const Bsdf::Sides sides = bsdf->sides();
    surface.front = sides.front != nullptr ? sides.front : bsdf;
    surface.back = sides.back != nullptr ? sides.back : bsdf;
    surface.two_sided = sides.front != nullptr;
    surface.transmits = bsdf->transmits();
    if (shape.interior_medium != kNoMedium && !surface.transmits) {
      warnings_.push_back(shape.name +
                          ": the medium inside lies behind an opaque material, so no light reaches it; null, dielectric " +
                          "and roughdielectric let light in");
    }
    surface.has_continuous_lobe = bsdf->has_continuous_lobe();
    surface.chooses_lobe = bsdf->chooses_lobe();
    const MaterialNeeds needs = material_needs(description, static_cast<std::size_t>(shape.material));
    surface.anisotropic = needs.tangents;
    surface.bumpy = needs.uv_derivatives;
    surface.vertex_colored = needs.vertex_colors;
    const TexturedSides& sides_with_textures =
        textured_sides_.emplace_back(textured_sides(description.materials, static_cast<std::size_t>(shape.material)));
    surface.textured = sides_with_textures.front != nullptr || sides_with_textures.back != nullptr;
    census_.anisotropic_materials |= needs.anisotropic;
    census_.normal_maps |= needs.normal_maps;
    census_.vertex_colors |= needs.vertex_colors;
    census_.masks |= needs.masks;
    surface.glossy = needs.glossy;
    census_.delta_lobes |= needs.delta_lobes;
    const bool null = is_null(description.materials[static_cast<std::size_t>(shape.material)]);
    census_.null_boundaries |= null;
    census_.delta_materials |= !surface.has_continuous_lobe && !shape.emitted_radiance && !null;
    const auto* instance = dynamic_cast<const MeshInstance*>(surface.shape.get());
    const auto* mesh = instance != nullptr ? &instance->mesh() : dynamic_cast<const TriangleMesh*>(surface.shape.get());
    census_.instances += instance != nullptr;
    if (needs.vertex_colors && (mesh == nullptr || mesh->data().colors.empty())) {
      throw SceneError(shape.name,
                       "its material shows the attribute vertex_color, which the shape lacks; expected a mesh with colours");
    }
    if (needs.vertex_colors) check_colors(shape.name, mesh->data().colors);
    const bool first_use = instance == nullptr || counted.insert(mesh).second;
    if (mesh != nullptr && first_use) {
      census_.triangles += mesh->triangles();
      census_.shading_normals |= !mesh->data().normals.empty();
      if (needs.uvs && mesh->data().uvs.empty()) {
        warnings_.push_back(shape.name + ": the mesh has no texture coordinates; its texture fills every triangle by itself");
      }
    }
    if (shape.emitted_radiance) {
      area_emitters_.push_back(std::make_unique<AreaEmitter>(*surface.shape, *shape.emitted_radiance, shape.emits_on_both_sides));
      surface.emitter = area_emitters_.back().get();
    }
    surfaces_.push_back(std::move(surface));
  }
  accelerator_->build();
  if (census_.media > 0 || census_.null_boundaries) {
    for (const ShapeDescription& shape : description.shapes) {
      boundaries_.push_back(boundary_of(shape, description.materials[static_cast<std::size_t>(shape.material)]));
    }
  }

  const Bounds bounds = bounds_of(surfaces_);
  if (!bounds.empty()) center_ = bounds.center();
  radius_ = bounds.radius();
  for (const EmitterDescription& emitter : description.emitters) {
    check_reach(emitter);
    if (auto made = make_emitter(emitter, radius_)) free_emitters_.push_back(std::move(made));
    if (const auto* constant = std::get_if<ConstantEmitterDescription>(&emitter)) {
      environment_ = environment_.value_or(Rgb{}) + constant->radiance;
    }
    census_.point_emitters += std::holds_alternative<PointEmitterDescription>(emitter);
    census_.spot_emitters += std::holds_alternative<SpotEmitterDescription>(emitter);
    census_.directional_emitters += std::holds_alternative<DirectionalEmitterDescription>(emitter);
  }
  const auto is_mask = [](const MaterialDescription& material) { return std::holds_alternative<MaskDescription>(material); };
  if (census_.point_emitters + census_.spot_emitters + census_.directional_emitters > 0 &&
      std::any_of(description.materials.begin(), description.materials.end(), is_mask)) {
    warnings_.push_back(
        "materials: masks cast whole shadows of point, spot and directional emitters, whose light does not pass them");
  }
  for (const auto& emitter : area_emitters_) emitter_list_.push_back(emitter.get());
  for (const auto& emitter : free_emitters_) emitter_list_.push_back(emitter.get());
  emitter_choice_ = EmitterChoice(emitter_list_);
  std::uint32_t index = 0;
  for (Surface& surface : surfaces_) {
    if (surface.emitter != nullptr) surface.emitter_index = index++;
  }
  for (const auto& emitter : free_emitters_) {
    const auto* map = dynamic_cast<const EnvmapEmitter*>(emitter.get());
    if (map != nullptr) environment_map_ = {map, emitter_choice_.distant_probability(index)};
    ++index;
  }
  census_.shapes = surfaces_.size();
  census_.area_emitters = area_emitters_.size();
  census_.environment = environment_.has_value();
  census_.environment_map = environment_map_.emitter != nullptr;
}

Scene::Boundary Scene::boundary_of(const ShapeDescription& shape, const MaterialDescription& material) const {
  const HomogeneousMedium* interior = medium(shape.interior_medium);
  const HomogeneousMedium* exterior = medium(shape.exterior_medium);
  return {interior, exterior, interior != nullptr || exterior != nullptr, is_null(material)};
}

const HomogeneousMedium* Scene::medium(int index) const {
  return index == kNoMedium ? nullptr : &media_[static_cast<std::size_t>(index)];
}

Scene::TexturedSides Scene::textured_sides(const std::vector<MaterialDescription>& materials, std::size_t material) const {
  const auto textured = [&](std::size_t index) { return textured_materials_[index].get(); };
  if (const auto* twosided = std::get_if<TwosidedDescription>(&materials[material])) {
    return {textured(static_cast<std::size_t>(twosided->front)), textured(static_cast<std::size_t>(twosided->back))};
  }
  return {textured(material), textured(material)};
}

}  // namespace fluxfarm
