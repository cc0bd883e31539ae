#include "scene/scene.h"

#include "materials/make_bsdf.h"
#include "materials/make_textured.h"
#include "scene/make_emitter.h"
#include "scene/make_shape.h"

namespace fluxfarm {
namespace {

bool is_anisotropic(const std::vector<MaterialDescription>& materials, const MaterialDescription& material) {
  const auto differs = [](const Roughness& r) { return r.alpha_u != r.alpha_v; };
  if (const auto* conductor = std::get_if<RoughConductorDescription>(&material)) return differs(conductor->roughness);
  if (const auto* dielectric = std::get_if<RoughDielectricDescription>(&material)) return differs(dielectric->roughness);
  if (const auto* twosided = std::get_if<TwosidedDescription>(&material)) {
    return is_anisotropic(materials, materials[twosided->front]) || is_anisotropic(materials, materials[twosided->back]);
  }
  return false;
}

Bounds bounds_of(const std::vector<Scene::Surface>& surfaces) {
  Bounds bounds;
  for (const Scene::Surface& surface : surfaces) {
    const Bounds own = surface.shape->bounds();
    bounds.extend(own.lower);
    bounds.extend(own.upper);
  }
  return bounds;
}

}  // namespace

Scene::Scene(const SceneDescription& description, int threads)
    : film_(description.film),
      method_(description.method),
      pixel_filter_(description.film.filter),
      camera_(description.camera, description.film.width, description.film.height),
      bsdfs_(make_bsdfs(description.materials)),
      textures_(make_textures(description.textures)),
      textured_materials_(make_textured_materials(description.materials, bsdfs_, textures_)),
      accelerator_(std::make_unique<RayAccelerator>(threads)),
      warnings_(description.warnings) {
  census_.materials = bsdfs_.size();
  census_.textures = textures_.size();
  surfaces_.reserve(description.shapes.size());
  for (const ShapeDescription& shape : description.shapes) {
    Surface surface;
    surface.shape = add_shape(shape, shape.emitted_radiance.has_value(), *accelerator_);
    const Bsdf* bsdf = bsdfs_[static_cast<std::size_t>(shape.material)].get();
    const Bsdf::Sides sides = bsdf->sides();
    surface.front = sides.front != nullptr ? sides.front : bsdf;
    surface.back = sides.back != nullptr ? sides.back : bsdf;
    surface.two_sided = sides.front != nullptr;
    surface.transmits = bsdf->transmits();
    surface.has_continuous_lobe = bsdf->has_continuous_lobe();
    surface.chooses_lobe = bsdf->chooses_lobe();
    surface.anisotropic = is_anisotropic(description.materials, description.materials[shape.material]);
    const TexturedSides& sides_with_textures =
        textured_sides_.emplace_back(textured_sides(description.materials, static_cast<std::size_t>(shape.material)));
    surface.textured = sides_with_textures.front != nullptr || sides_with_textures.back != nullptr;
    census_.anisotropic_materials |= surface.anisotropic;
    census_.delta_materials |= !surface.has_continuous_lobe && !shape.emitted_radiance;
    if (const auto* mesh = dynamic_cast<const TriangleMesh*>(surface.shape.get())) {
      census_.triangles += mesh->triangles();
      census_.shading_normals |= !mesh->data().normals.empty();
      if (surface.textured && mesh->data().uvs.empty()) {
        warnings_.push_back(shape.name + ": the mesh has no texture coordinates; its texture fills every triangle by itself");
      }
    }
    if (shape.emitted_radiance) {
      area_emitters_.push_back(std::make_unique<AreaEmitter>(*surface.shape, *shape.emitted_radiance));
      surface.emitter = area_emitters_.back().get();
    }
    surfaces_.push_back(std::move(surface));
  }
  accelerator_->build();

  const float radius = bounds_of(surfaces_).radius();
  for (const EmitterDescription& emitter : description.emitters) {
    if (auto made = make_emitter(emitter, radius)) free_emitters_.push_back(std::move(made));
    if (const auto* constant = std::get_if<ConstantEmitterDescription>(&emitter)) {
      environment_ = environment_.value_or(Rgb{}) + constant->radiance;
    }
    census_.point_emitters += std::holds_alternative<PointEmitterDescription>(emitter);
    census_.spot_emitters += std::holds_alternative<SpotEmitterDescription>(emitter);
    census_.directional_emitters += std::holds_alternative<DirectionalEmitterDescription>(emitter);
  }
  std::vector<const Emitter*> emitters;
  for (const auto& emitter : area_emitters_) emitters.push_back(emitter.get());
  for (const auto& emitter : free_emitters_) emitters.push_back(emitter.get());
  emitter_choice_ = EmitterChoice(emitters);
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

Scene::TexturedSides Scene::textured_sides(const std::vector<MaterialDescription>& materials, std::size_t material) const {
  const auto textured = [&](std::size_t index) { return textured_materials_[index].get(); };
  if (const auto* twosided = std::get_if<TwosidedDescription>(&materials[material])) {
    return {textured(static_cast<std::size_t>(twosided->front)), textured(static_cast<std::size_t>(twosided->back))};
  }
  return {textured(material), textured(material)};
}

}  // namespace fluxfarm
