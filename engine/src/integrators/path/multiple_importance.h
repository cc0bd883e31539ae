// What estimators of direct light share: the weights of two techniques, and the way to a chosen point of a light.
//
// [Veach97] E. Veach, "Robust Monte Carlo Methods for Light Transport Simulation", PhD thesis, Stanford 1997.
#pragma once

#include <optional>

#include "emitters/emitter.h"
#include "math/ray.h"
#include "scene/scene.h"

namespace fluxfarm {

// Power heuristic with exponent two for one sample of each of two techniques.                      [Veach97, section 9.2.4]
inline float power_heuristic(float pdf, float other_pdf) {
  if (!(pdf > 0)) return 0;
  const float ratio = other_pdf / pdf;
  return 1 / (1 + ratio * ratio);
}

// Light from outside that a ray finds whose direction was chosen with `pdf` (sr^-1; unused if next-event estimation could not have
// found that direction: `delta`). Next-event estimation could have found that of the map, too, but never the constant one.
// `map_share`, `constant_share`: the parts of their light that are to be found in this way at all.
inline Rgb environment_found(const Scene& scene, Vec3f direction, bool delta, float pdf, float map_share = 1,
                             float constant_share = 1) {
  const Rgb found = scene.environment().value_or(Rgb{}) * constant_share;
  const auto& [map, choice_probability] = scene.environment_map();
  if (map == nullptr) return found;
  const auto [radiance, light_pdf] = map->from(direction);
  return found + radiance * (map_share * (delta ? 1.0f : power_heuristic(pdf, light_pdf * choice_probability)));
}

// The ray from a point, already moved off its surface, to one that is moved off the light. Empty: they coincide.
inline std::optional<Ray> shadow_ray(Vec3f from, const EmitterSample& light) {
  if (light.distance == kDistant) return Ray{from, light.wi};
  const Vec3f to = light.delta ? light.position : offset_point(light.position, light.normal);
  const Vec3f segment = to - from;
  const float distance = length(segment);
  if (!(distance > 0)) return std::nullopt;
  return Ray{from, segment / distance, 0, distance * (1 - 1e-5f)};
}

}  // namespace fluxfarm
