// Records of irradiance, and what they say together of any place. Frozen once made: any number of threads may ask.
//
// Held in a tree of boxes around where the records are used: a place is in few of them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "integrators/irradiance/bounds_tree.h"
#include "integrators/irradiance/irradiance_record.h"

namespace fluxfarm {

// Where irradiance is asked for.
struct ReceivingPlace {
  Vec3f position;  // world, m
  Vec3f normal;    // shading normal towards the light, unit
  int room = 0;    // of surfaces that light may have met, with this one
};

class IrradianceCache {
 public:
  IrradianceCache() = default;
  // `max_angle`: between the normals of a record and of a place where it is used, rad.
  IrradianceCache(std::vector<IrradianceRecord> records, float max_angle);

  std::span<const IrradianceRecord> records() const { return records_; }
  std::size_t bytes() const { return records_.size() * sizeof(IrradianceRecord) + tree_.bytes(); }

  struct Interpolated {
    Rgb irradiance;  // W m^-2, with the noise of the replicate's strata
    Rgb error;       // of it by interpolation, as far as the records can tell; without its sign
  };
  // Empty: no record is close enough.
  std::optional<Interpolated> interpolate(const ReceivingPlace& place, std::uint32_t replicate) const;
  bool covers(const ReceivingPlace& place) const;

 private:
  // Weights of all records together below which they say too little: at the very rim of a single one (a choice).
  static constexpr float kLeastWeight = 0.05f;

  std::vector<IrradianceRecord> records_;
  BoundsTree tree_;  // its leaves hold records_
  float per_angle_squared_ = 1;
};

}  // namespace fluxfarm
