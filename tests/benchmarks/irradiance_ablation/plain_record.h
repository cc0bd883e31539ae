// A record of irradiance as the compared methods have it: where it is used, how much it weighs there and what it says.
#pragma once

#include "known_place.h"
#include "method.h"

namespace fluxfarm::ablation {

class PlainRecord {
 public:
  // `known` has to outlive the record. `scene_radius`: no record is used farther, m.
  PlainRecord(const KnownPlace& known, const Method& method, const Limits& limits, float scene_radius);

  // Zero where the record is not used.
  float weight(const GatherPlace& place) const { return split_sphere_ ? weight_by_sphere(place) : weight_by_ellipse(place); }

  // Irradiance at a place by all strata and by each half of them, W m^-2.
  struct Told {
    float all = 0;
    std::array<float, 2> by_half{};
  };
  Told told(const GatherPlace& place) const;

  // Of the tangent plane's ellipse d^T M d < 1, m^-2.
  const TangentMatrix& metric() const { return metric_; }

 private:
  // [Ward88]: one over the sum of distance over radius and angle between normals, less that at the tolerance, so that it falls to
  // zero there. None where the record lies before the place, for it does not see what the place sees.
  float weight_by_sphere(const GatherPlace& place) const;
  // As of IrradianceRecord.
  float weight_by_ellipse(const GatherPlace& place) const;

  const KnownPlace* known_;
  bool split_sphere_;
  float per_tolerance_;
  PlaneGradient gradient_;
  bool turns_;
  TangentMatrix metric_;
};

}  // namespace fluxfarm::ablation
