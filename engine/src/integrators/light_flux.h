// What methods share that follow light from its emitters: where its flux starts, and what a surface makes of it.
//
// [Veach97] E. Veach, "Robust Monte Carlo Methods for Light Transport Simulation", PhD thesis, Stanford 1997.
#pragma once

#include <optional>
#include <vector>

#include "integrators/key_random.h"
#include "integrators/path/path_vertex.h"
#include "sampling/discrete_distribution.h"
#include "scene/scene.h"

namespace fluxfarm {

// Chooses rays on which light leaves the emitters.
class ParticleSource {
 public:
  // Mean of R, G and B of the power of each emitter, W: those of the scene's list in order, and last the constant environment if
  // the scene has one. An emitter whose power is beyond all numbers cannot be followed and counts as 0.
  static std::vector<double> powers(const Scene& scene);

  // Emitters are chosen in proportion to `weights`, one for each of powers(); without the last one the constant environment is
  // not followed. Must not be empty.
  ParticleSource(const Scene& scene, const std::vector<double>& weights) : scene_(scene), choice_(weights) {}

  // A ray of one emitter, counted as in powers(), and what holds those of a part of it. As Emitter::emit() and emission_bounds().
  static std::optional<EmissionSample> emit_from(const Scene& scene, std::size_t emitter, Vec2f u_point, Vec2f u_direction);
  static EmissionBounds bounds(const Scene& scene, std::size_t emitter, const EmissionCell& cell);

  // A ray with the flux that it stands for when it is the only one: divide by their number. `place` in [0,1) picks the emitter, and
  // emitters have their part of that interval in order. Empty: no light leaves there.
  std::optional<EmissionSample> emit(double place, Vec2f u_point, Vec2f u_direction) const;

 private:
  const Scene& scene_;
  DiscreteDistribution choice_;
};

// How flux goes on from a surface.
struct ScatteredFlux {
  Vec3f direction;     // world, unit
  Rgb share;           // of the flux that arrived, which goes there in the mean
  float value;         // of the lobe for light that goes that way, largest channel, sr^-1; infinite for a delta lobe
  bool delta, passes;  // as in BsdfSample
};

// What becomes of flux that arrived from `from` (world, unit, leaves the surface), by the BSDF's own sampling. Empty: absorbed.
std::optional<ScatteredFlux> scatter_flux(const PathVertex& vertex, Vec3f from, KeyRandom& random);

}  // namespace fluxfarm
