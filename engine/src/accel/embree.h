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

// Sixteen rays at once; lanes with valid[i] == 0 are left alone, the others have valid[i] == -1. `coherent`: the rays
// start and point alike.
inline void embree_intersect(RTCScene scene, const int* valid, bool coherent, RTCRayHit16& ray_hits) {
#if FLUXFARM_EMBREE_MAJOR == 4
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  if (coherent) arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect16(valid, scene, &ray_hits, &arguments);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect16(valid, scene, &context, &ray_hits);
#endif
}

inline void embree_occluded(RTCScene scene, const int* valid, bool coherent, RTCRay16& rays) {
#if FLUXFARM_EMBREE_MAJOR == 4
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  if (coherent) arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcOccluded16(valid, scene, &rays, &arguments);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded16(valid, scene, &context, &rays);
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
