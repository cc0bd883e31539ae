#include "integrators/photon/disk_in_sight.h"

#include <algorithm>

namespace fluxfarm {

bool DiskInSight::meets_surface(Vec2f place) const {
  const float height = std::min(patch_.max_plane_distance(), radius_);
  Ray down{patch_.position() + frame_.to_world({place.x, place.y, height}), -frame_.n, 0, 2 * height};
  for (int through = 0; through <= kMostOverhangs; ++through) {
    Hit hit;
    queries_.intersect({&down, 1}, {&hit, 1}, false);
    if (hit.shape == Hit::kNone) return false;
    const Scene::Surface& surface = scene_.surface(hit.shape);
    const SurfacePoint point = surface.shape->surface_point(down, hit);
    if (patch_.goes_on(point.position - patch_.position(), point.geometric_normal)) {
      return surface.has_continuous_lobe && sees(point.position, point.geometric_normal);  // others keep no photons
    }
    if (!hangs_over(point.geometric_normal)) return false;
    down.origin =
        offset_point(point.position, point.geometric_normal * std::copysign(1.0f, -dot(point.geometric_normal, frame_.n)));
    down.t_max -= hit.t;
  }
  return false;
}

bool DiskInSight::sees(Vec3f place, Vec3f normal) const {
  const Vec3f above = normal * std::copysign(kLift * radius_, dot(normal, frame_.n));
  const Vec3f way = place + above - lifted_;
  const float distance = length(way);
  if (!(distance > 0)) return true;
  const Ray ray{lifted_, way / distance, 0, distance};
  Hit hit;
  queries_.intersect({&ray, 1}, {&hit, 1}, false);
  if (hit.shape == Hit::kNone) return true;
  return hangs_over(scene_.surface(hit.shape).shape->surface_point(ray, hit).geometric_normal);
}

}  // namespace fluxfarm
