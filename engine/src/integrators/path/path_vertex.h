// A vertex of a path: the surface that a ray met, in the frame in which its BSDF is asked.
#pragma once

#include <cmath>

#include "math/frame.h"
#include "scene/scene.h"

namespace fluxfarm {

struct PathVertex {
  const Scene::Surface& surface;
  SurfacePoint point;
  Frame frame;  // around the shading normal
  Vec3f wo;     // local, towards where the path came from

  PathVertex(const Scene& scene, const Ray& ray, const Hit& hit) : surface(scene.surface(hit.shape)) {
    point = surface.shape->surface_point(ray, hit);
    frame = Frame(point.shading_normal);
    if (surface.anisotropic) align(surface.shape->tangent(point, hit));
    wo = frame.to_local(-ray.direction);
  }

  // Where a ray towards `direction` (world) may start without meeting its own surface.
  Vec3f origin_towards(Vec3f direction) const {
    const Vec3f n = point.geometric_normal;
    return offset_point(point.position, n * std::copysign(1.0f, dot(n, direction)));
  }

 private:
  void align(Vec3f tangent) {
    const Vec3f s = tangent - dot(tangent, frame.n) * frame.n;
    const float squared = length_squared(s);
    if (!(squared > 0)) return;
    frame.s = s / std::sqrt(squared);
    frame.t = cross(frame.n, frame.s);
  }
};

}  // namespace fluxfarm
