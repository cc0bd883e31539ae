// A vertex of a path: the surface that a ray met, in the frame in which its BSDF is asked.
#pragma once

#include <cmath>

#include "math/frame.h"
#include "scene/scene.h"

namespace fluxfarm {

struct PathVertex {
  const Scene::Surface* surface = nullptr;
  SurfacePoint point;
  Frame frame;                 // around the shading normal; on a two-sided surface turned to the side of wo
  Vec3f wo;                    // local, towards where the path came from
  const Bsdf* bsdf = nullptr;  // of that side

  PathVertex() = default;
  // A textured surface has its BSDF made in `space`.
  PathVertex(const Scene& scene, const Ray& ray, const Hit& hit, BsdfSpace& space)
      : surface(&scene.surface(hit.shape)), point(surface->shape->surface_point(ray, hit)), frame(point.shading_normal) {
    if (surface->anisotropic) align(surface->shape->tangent(point, hit));
    wo = frame.to_local(-ray.direction);
    const bool back = wo.z < 0;
    const float side = back && surface->two_sided ? -1.0f : 1.0f;
    frame.n *= side;
    wo.z *= side;
    bsdf = back ? surface->back : surface->front;
    if (surface->textured) [[unlikely]]
      look_up(scene, hit, back, side, space);
  }

  // What the choice of an emitter may know: the material takes light along the shading normal, on the side of wo unless it
  // transmits.
  EmitterReference emitter_reference() const { return {point.position, wo.z < 0 ? -frame.n : frame.n, surface->transmits}; }

  // Where a ray towards `direction` (world) may start without meeting its own surface.
  Vec3f origin_towards(Vec3f direction) const {
    const Vec3f n = point.geometric_normal;
    return offset_point(point.position, n * std::copysign(1.0f, dot(n, direction)));
  }

 private:
  void look_up(const Scene& scene, const Hit& hit, bool back, float side, BsdfSpace& space) {
    const TexturedMaterial* material = scene.textured_material(hit.shape, back);
    if (material == nullptr) return;
    MaterialPoint place{.texture = {.uv = surface->shape->uv(point, hit)}};
    if (surface->vertex_colored) place.texture.vertex_color = surface->shape->vertex_color(hit);
    if (surface->bumpy) {
      const Shape::UvDerivatives d = surface->shape->uv_derivatives(point, hit);
      place.dp_du = frame.to_local(d.dp_du);
      place.dp_dv = frame.to_local(d.dp_dv);
      place.geometric_normal = frame.to_local(point.geometric_normal);
      place.geometric_normal.z *= side;  // as before the frame was turned to the side of wo
    }
    bsdf = &material->at(place, space);
  }

  void align(Vec3f tangent) {
    const Vec3f s = tangent - dot(tangent, frame.n) * frame.n;
    const float squared = length_squared(s);
    if (!(squared > 0)) return;
    frame.s = s / std::sqrt(squared);
    frame.t = cross(frame.n, frame.s);
  }
};

}  // namespace fluxfarm
