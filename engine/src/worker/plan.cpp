#include "worker/plan.h"

#include <nlohmann/json.hpp>

#include "integrators/audit/light_audit.h"

namespace fluxfarm {
namespace {

nlohmann::json part(const char* name, bool on, const std::string& reason) {
  return {{"part", name}, {"on", on}, {"reason", reason}};
}

nlohmann::json part_of_method(const char* name, bool on, const Integrator& integrator, const char* what_for) {
  return part(name, on, on ? what_for : std::string(integrator.name()) + " makes none of this scene");
}

std::string count(std::size_t number, const char* noun) { return std::to_string(number) + " " + noun + (number == 1 ? "" : "s"); }

nlohmann::json as_json(const Goal& goal) {
  if (goal.rel_error) return {{"rel_error", *goal.rel_error}};
  if (goal.seconds) return {{"seconds", *goal.seconds}};
  return {{"spp", goal.spp.value_or(0)}};
}

nlohmann::json as_json(const MethodChoice& choice) {
  nlohmann::json methods = nlohmann::json::array();
  for (const MethodCandidate& candidate : choice.candidates) {
    nlohmann::json method = {{"method", candidate.method}, {"tried", candidate.forecast.has_value()}, {"reason", candidate.reason}};
    if (candidate.forecast) {
      method["error"] = candidate.forecast->error;
      method["samples"] = candidate.forecast->samples;
      method["seconds"] = candidate.forecast->seconds;
      method["work"] = candidate.forecast->work;
    }
    methods.push_back(method);
  }
  return {{"reason", choice.reason},
          {"goal", as_json(choice.goal)},
          {"seconds", choice.seconds},
          {"expected_seconds", choice.expected_seconds},
          {"methods", methods}};
}

}  // namespace

std::string plan_json(const Scene& scene, const Integrator& integrator, const MethodChoice* choice) {
  const Census& census = scene.census();
  const std::size_t emitters =
      census.area_emitters + census.point_emitters + census.spot_emitters + census.directional_emitters + census.environment_map;
  const AuditNeed audit = audit_need(scene);
  const MethodParts of_method = integrator.parts();
  nlohmann::json plan = {
      {"integrator", integrator.name()},
      {"census",
       {{"shapes", census.shapes},
        {"triangles", census.triangles},
        {"instances", census.instances},
        {"materials", census.materials},
        {"textures", census.textures},
        {"area_emitters", census.area_emitters},
        {"point_emitters", census.point_emitters},
        {"spot_emitters", census.spot_emitters},
        {"directional_emitters", census.directional_emitters},
        {"environment", census.environment},
        {"environment_map", census.environment_map},
        {"media", census.media},
        {"null_boundaries", census.null_boundaries},
        {"delta_materials", census.delta_materials},
        {"delta_lobes", census.delta_lobes},
        {"masks", census.masks},
        {"normal_maps", census.normal_maps},
        {"vertex_colors", census.vertex_colors}}},
      {"parts",
       {part("lens", scene.camera().has_lens(), scene.camera().has_lens() ? "a sensor with an aperture" : "a pinhole"),
        part("next-event estimation", emitters > 0, count(emitters, "emitter") + " that can be sampled"),
        part("emitter choice", emitters > 1, count(emitters, "emitter") + " to choose from"),
        part("emitter tree", scene.emitters().by_place(), count(scene.emitters().candidates(), "emitter or triangle")),
        part("light-side audit", audit.kind == AuditNeed::kNeeded, audit.reason),
        part_of_method("caustic map", of_method.caustic_map, integrator,
                       "for light that mirrors, glass and gloss bring to surfaces"),
        part_of_method("projection map", of_method.projection_map, integrator, "so that photons start towards what makes caustics"),
        part_of_method("volume map", of_method.volume_map, integrator, "for light in media"),
        part_of_method("global map", of_method.global_map, integrator, "for all indirect light"),
        part_of_method("irradiance cache", of_method.irradiance_cache, integrator, "for indirect light on diffuse surfaces"),
        part("environment", census.environment, census.environment ? "a constant environment" : "no environment"),
        part("environment map", census.environment_map, census.environment_map ? "an envmap" : "no envmap"),
        part("tangent frames", census.anisotropic_materials || census.normal_maps,
             census.anisotropic_materials ? "a material with two roughnesses"
             : census.normal_maps         ? "normals from a texture"
                                          : "no anisotropic material"),
        part("normal maps", census.normal_maps, census.normal_maps ? "a normalmap or bumpmap" : "no normalmap, no bumpmap"),
        part("vertex colours", census.vertex_colors, census.vertex_colors ? "a mesh_attribute in use" : "no mesh_attribute in use"),
        part("media", census.media > 0 || census.null_boundaries,
             census.media > 0         ? (census.media == 1 ? "1 medium" : std::to_string(census.media) + " media")
             : census.null_boundaries ? "no medium, but surfaces that light passes"
                                      : "no medium"),
        part("media channels", census.coloured_media,
             census.coloured_media ? "a medium whose extinction has a colour" : "no extinction has a colour"),
        part("textures", census.textures > 0, count(census.textures, "texture")),
        part("instances", census.instances > 0, count(census.instances, "instance") + " of shared meshes"),
        part("specular and caustic layers", census.delta_lobes,
             census.delta_lobes ? "a smooth mirror, glass or coat" : "nothing smooth"),
        part("volume layer", census.media > 0, census.media > 0 ? "a medium" : "no medium"),
        part("shading normals", census.shading_normals,
             census.shading_normals ? "a mesh with normals" : "all surfaces flat or exact")}}};
  if (choice != nullptr) plan["choice"] = as_json(*choice);
  return plan.dump();
}

}  // namespace fluxfarm
