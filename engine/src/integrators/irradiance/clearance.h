// The space around a place that is free of surfaces, as far as is known.
//
// A gather's rays miss what is small, and what is low over the horizon. Others, from nearby, see it.
// [Krivanek06] J. Krivanek, K. Bouatouch, S. Pattanaik, J. Zara, "Making Radiance and Irradiance Caching Practical: Adaptive
// Caching and Neighbor Clamping", EGSR 2006: there distances to what is near are compared; here it is points.
#pragma once

#include <cmath>

#include "integrators/irradiance/edge_irradiance.h"
#include "math/vec.h"

namespace fluxfarm {

// Whether a point (from a place, in its frame, z along the normal, m) is one of another surface, that rises before the place:
// flatter ones are on the place's own surface.
inline bool is_above_surface(Vec3f point) {
  constexpr float kFlat = 1e-3f;  // slope (a choice)
  return point.z > kFlat * length(point);
}

// Shrinks the ellipse d^T clearance d < 1 of the tangent plane, m^-2, so that the space around it leaves out such a point that the
// place's own rays have missed.
inline void keep_clear_of(Vec3f missed, TangentMatrix& clearance) {
  constexpr double kPart = 0.8;  // of the way there: the point need not be the nearest of its surface (a choice)
  const double x = kPart * static_cast<double>(missed.x), y = kPart * static_cast<double>(missed.y),
               z = kPart * static_cast<double>(missed.z);
  const double squared = x * x + y * y + z * z;
  const double across = (clearance.xx + clearance.yy) / 2 + std::hypot((clearance.xx - clearance.yy) / 2, clearance.xy);
  const double missing = 1 - clearance.along(x, y) - across * z * z;
  if (!(missing > 0)) return;
  // Towards the point as far as it lies to the side, and all around as far as it lies above.
  const double scale = missing / (squared * squared);
  clearance.xx += scale * (x * x + z * z);
  clearance.xy += scale * x * y;
  clearance.yy += scale * (y * y + z * z);
}

}  // namespace fluxfarm
