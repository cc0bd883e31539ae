// The medium in which light starts: emitters do not say it, but the camera does for itself, and surfaces do for their two sides.
#pragma once

#include "accel/ray_queries.h"
#include "scene/scene.h"

namespace fluxfarm {

// Around a place (world, m; not on a surface) of a scene with media or null boundaries. On the way from there to the camera the
// first surface with media of its own tells; without one the place is in the camera's medium. nullptr: vacuum.
inline const HomogeneousMedium* surrounding_medium(const Scene& scene, Vec3f place, RayQueries& queries) {
  const Vec3f to_camera = scene.camera().position() - place;
  const float distance = length(to_camera);
  if (!(distance > 0)) return scene.camera_medium();
  Ray ray{place, to_camera / distance, 0, distance};
  for (Hit hit;; ray.t_max -= hit.t) {
    queries.intersect({&ray, 1}, {&hit, 1}, false);
    if (hit.shape == Hit::kNone) return scene.camera_medium();
    const SurfacePoint point = scene.surface(hit.shape).shape->surface_point(ray, hit);
    const Scene::Boundary& boundary = scene.boundary(hit.shape);
    if (boundary.separates) return boundary.towards(-ray.direction, point, nullptr);
    ray.origin =
        offset_point(point.position, point.geometric_normal * std::copysign(1.0f, dot(point.geometric_normal, ray.direction)));
  }
}

}  // namespace fluxfarm
