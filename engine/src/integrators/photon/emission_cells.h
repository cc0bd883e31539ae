// Cuts emitters into the parts that may shine on given balls and those that cannot.
//
// An emitter is the unit hypercube of the random numbers of Emitter::emit(), two for a point and two for a direction. Its cells are
// halved, the one first that wastes most light past the balls, across the number that spreads its rays most; a half is dropped when
// the bounds of its rays miss every ball. So a point light is cut by direction, the sun by place, a lamp or a sky by both, as
// finely as the balls ask for. Lamps that are curved or have many triangles are masked loosely: their cells have many directions.
#pragma once

#include <cstdint>
#include <vector>

#include "emitters/emission_bounds.h"
#include "scene/scene.h"

namespace fluxfarm {

struct KeptCell {
  std::uint32_t emitter = 0;  // as ParticleSource::powers() counts
  EmissionCell cell;
  double power = 0;  // about what leaves it, W, mean over R, G and B; above zero
};

struct EmissionCells {
  std::vector<KeptCell> kept;  // those of an emitter stand together, emitters in order
  // What leaves the rest, W. To rounding where an emitter sends the same flux with all of its random numbers; of spot lights with a
  // slope and of environment maps it is found from a few rays of each cell, to some 0.3 %.
  double left_out = 0;
};

// Keeps every ray that would meet a ball if nothing were in between, and some that would not.
EmissionCells cells_that_meet(const Scene& scene, const std::vector<Ball>& balls);

}  // namespace fluxfarm
