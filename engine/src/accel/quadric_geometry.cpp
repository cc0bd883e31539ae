// [Haines19] E. Haines et al., "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems, ch. 7.
#include "accel/quadric_geometry.h"

#include <cmath>
#include <limits>
#include <utility>

namespace fluxfarm {
namespace {

struct Interval {
  float lower, upper;
  bool contains(float t) const { return t > lower && t < upper; }
};

// Distance of the first crossing inside the interval, or a negative number.
float hit_distance(const Sphere& sphere, Vec3f origin, Vec3f direction, Interval interval) {
  const Vec3f f = origin - sphere.center();
  const float a = length_squared(direction);
  const float b = -dot(f, direction);
  // The discriminant as radius^2 minus the squared distance of the centre to the line keeps its digits.     [Haines19]
  const float discriminant = sqr(sphere.radius()) - length_squared(f + (b / a) * direction);
  if (discriminant < 0) return -1;
  const float c = length_squared(f) - sqr(sphere.radius());
  const float q = b + std::copysign(std::sqrt(a * discriminant), b);
  float near = c / q, far = q / a;
  if (near > far) std::swap(near, far);
  if (interval.contains(near)) return near;
  return interval.contains(far) ? far : -1;
}

float hit_distance(const Disk& disk, Vec3f origin, Vec3f direction, Interval interval) {
  const float t = dot(disk.center() - origin, disk.normal()) / dot(direction, disk.normal());
  if (!interval.contains(t)) return -1;  // also when parallel: t is infinite or not a number
  return length_squared(origin + t * direction - disk.center()) <= sqr(disk.radius()) ? t : -1;
}

template <typename Quadric>
void bound(const RTCBoundsFunctionArguments* arguments) {
  const Bounds b = static_cast<const Quadric*>(arguments->geometryUserPtr)->bounds();
  // A little room, as the bounds themselves were rounded.
  const float slack = 1e-5f * std::fmax(b.radius(), length(b.center()));
  RTCBounds& out = *arguments->bounds_o;
  out.lower_x = b.lower.x - slack;
  out.lower_y = b.lower.y - slack;
  out.lower_z = b.lower.z - slack;
  out.upper_x = b.upper.x + slack;
  out.upper_y = b.upper.y + slack;
  out.upper_z = b.upper.z + slack;
}

template <typename Quadric>
float hit_distance(const void* quadric, RTCRayN* rays, unsigned n, unsigned i) {
  return hit_distance(*static_cast<const Quadric*>(quadric),
                      {RTCRayN_org_x(rays, n, i), RTCRayN_org_y(rays, n, i), RTCRayN_org_z(rays, n, i)},
                      {RTCRayN_dir_x(rays, n, i), RTCRayN_dir_y(rays, n, i), RTCRayN_dir_z(rays, n, i)},
                      {RTCRayN_tnear(rays, n, i), RTCRayN_tfar(rays, n, i)});
}

template <typename Quadric>
void intersect(const RTCIntersectFunctionNArguments* arguments) {
  const unsigned n = arguments->N;
  RTCRayN* rays = RTCRayHitN_RayN(arguments->rayhit, n);
  RTCHitN* hits = RTCRayHitN_HitN(arguments->rayhit, n);
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] == 0) continue;
    const float t = hit_distance<Quadric>(arguments->geometryUserPtr, rays, n, i);
    if (t < 0) continue;
    RTCRayN_tfar(rays, n, i) = t;
    RTCHitN_u(hits, n, i) = RTCHitN_v(hits, n, i) = 0;
    RTCHitN_primID(hits, n, i) = arguments->primID;
    RTCHitN_geomID(hits, n, i) = arguments->geomID;
    RTCHitN_instID(hits, n, i, 0) = arguments->context->instID[0];
  }
}

template <typename Quadric>
void occlude(const RTCOccludedFunctionNArguments* arguments) {
  const unsigned n = arguments->N;
  RTCRayN* rays = arguments->ray;
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] == 0 || hit_distance<Quadric>(arguments->geometryUserPtr, rays, n, i) < 0) continue;
    RTCRayN_tfar(rays, n, i) = -std::numeric_limits<float>::infinity();
  }
}

template <typename Quadric>
RTCGeometry make_geometry(RTCDevice device, const Quadric& quadric) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, 1);
  rtcSetGeometryUserData(geometry, const_cast<Quadric*>(&quadric));  // Embree hands it back as it came; we only read it
  rtcSetGeometryBoundsFunction(geometry, bound<Quadric>, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersect<Quadric>);
  rtcSetGeometryOccludedFunction(geometry, occlude<Quadric>);
  return geometry;
}

}  // namespace

RTCGeometry make_sphere_geometry(RTCDevice device, const Sphere& sphere) { return make_geometry(device, sphere); }

RTCGeometry make_disk_geometry(RTCDevice device, const Disk& disk) { return make_geometry(device, disk); }

}  // namespace fluxfarm
