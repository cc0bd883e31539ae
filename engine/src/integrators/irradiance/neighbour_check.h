// Records hold their neighbours to what these have found.
//
// A hemisphere tells of light as it is at one place. What it cannot tell - the edge of a shadow on the floor beside a wall, a slit
// to a bright room around the corner - the records nearby have seen.
#pragma once

#include <cmath>

#include "integrators/irradiance/hemisphere_sampler.h"
#include "integrators/irradiance/irradiance_record.h"

namespace fluxfarm {

// A record with what it was made of.
struct KeptRecord {
  GatherPlace place;
  HemisphereIrradiance light;
};

// Distance of records that are compared, over the radius (a choice).
inline constexpr float kCompared = 2;

// Raises a matrix whose product with a place, to the power 3/2, is an error (W m^-2), so that this is at least `error` at d, m.
inline void raise_misfit(TangentMatrix& misfit, Vec3f d, float error) {
  const double x = static_cast<double>(d.x), y = static_cast<double>(d.y), squared = x * x + y * y;
  const double missing = std::pow(static_cast<double>(error), 2.0 / 3) - misfit.along(x, y);
  if (!(missing > 0) || !(squared > 0)) return;
  const double scale = missing / (squared * squared);
  misfit.xx += scale * x * x;
  misfit.xy += scale * x * y;
  misfit.yy += scale * y * y;
}

// Notes in `kept`, of which `record` was made, by how much more than it claims and than noise explains it is wrong about the
// neighbour's place. `max_angle`: between normals of those that are compared, rad.
inline void check_by_neighbour(KeptRecord& kept, const IrradianceRecord& record, const KeptRecord& neighbour, float max_angle) {
  constexpr float kSure = 2;  // standard deviations of noise (a choice)
  const Vec3f normal = neighbour.place.frame.n;
  if (!(2 * (1 - dot(kept.place.frame.n, normal)) < max_angle * max_angle)) return;
  const Vec3f d = kept.place.frame.to_local(neighbour.place.position - kept.place.position);
  const IrradianceRecord::Use told = record.extrapolate(neighbour.place.position, normal);
  const float noise = std::hypot(kept.light.noise(), neighbour.light.noise(), kept.light.gradient_noise * std::hypot(d.x, d.y));
  const float wrong = std::fabs(luminance(told.irradiance) - luminance(neighbour.light.irradiance)) - kSure * noise;
  if (wrong > told.error) raise_misfit(kept.light.misfit, d, wrong);
}

}  // namespace fluxfarm
