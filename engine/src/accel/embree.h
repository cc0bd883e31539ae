// Embree 3 and 4 behind one spelling.
#pragma once

#if FLUXFARM_EMBREE_MAJOR == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

static_assert(RTC_VERSION_MAJOR == FLUXFARM_EMBREE_MAJOR, "CMake found another major version of Embree than its headers say");

namespace fluxfarm {

inline void embree_intersect(RTCScene scene, RTCRayHit& ray_hit) {
#if FLUXFARM_EMBREE_MAJOR == 4
  rtcIntersect1(scene, &ray_hit);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &ray_hit);
#endif
}

inline void embree_occluded(RTCScene scene, RTCRay& ray) {
#if FLUXFARM_EMBREE_MAJOR == 4
  rtcOccluded1(scene, &ray);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, &ray);
#endif
}

}  // namespace fluxfarm
