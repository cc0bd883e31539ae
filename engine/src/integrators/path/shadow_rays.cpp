#include "integrators/path/shadow_rays.h"

namespace fluxfarm {

void ShadowRays::gather(bool coherent) {
  if (!scene_.census().null_boundaries) {
    gather_unobstructed(coherent);
  } else {
    // Each round takes all rays to their next surface; those that pass it move down to the first free place.
    for (bool first = true; size_ > 0; first = false) {
      queries_.intersect({rays_.data(), size_}, {hits_.data(), size_}, coherent && first);
      std::size_t travelling = 0;
      for (std::size_t i = 0; i < size_; ++i) {
        if (!pass(i)) continue;
        rays_[travelling] = rays_[i];
        lights_[travelling++] = lights_[i];
      }
      size_ = travelling;
    }
  }
  size_ = 0;
}

// Every surface stops light: one question a ray, and one medium on its way.
void ShadowRays::gather_unobstructed(bool coherent) {
  queries_.occluded({rays_.data(), size_}, {occluded_.data(), size_}, coherent);
  for (std::size_t i = 0; i < size_; ++i) {
    if (occluded_[i]) continue;
    const Light& light = lights_[i];
    light.result->add(light.medium == nullptr ? light.radiance : light.radiance * light.medium->transmittance(rays_[i].t_max),
                      light.layer);
  }
}

// Takes ray i to its hit and past it. False when its way has ended: arrived, or stopped.
bool ShadowRays::pass(std::size_t i) {
  Ray& ray = rays_[i];
  Light& light = lights_[i];
  const Hit& hit = hits_[i];
  const bool arrives = hit.shape == Hit::kNone;
  if (!arrives && !scene_.boundary(hit.shape).invisible) return false;
  if (light.medium != nullptr) light.radiance *= light.medium->transmittance(arrives ? ray.t_max : hit.t);
  if (arrives) light.result->add(light.radiance, light.layer);
  if (arrives || light.radiance.is_black()) return false;
  const SurfacePoint point = scene_.surface(hit.shape).shape->surface_point(ray, hit);
  light.medium = scene_.boundary(hit.shape).towards(ray.direction, point, light.medium);
  ray.origin =
      offset_point(point.position, point.geometric_normal * std::copysign(1.0f, dot(point.geometric_normal, ray.direction)));
  ray.t_max -= hit.t;
  return true;
}

}  // namespace fluxfarm
