// Fills the hemisphere of a place with the light that comes there from other surfaces: a path for each stratum.
#pragma once

#include "integrators/irradiance/hemisphere_grid.h"
#include "integrators/path/path_group.h"

namespace fluxfarm {

// A place with all that light needs to get there.
struct GatherPlace {
  Vec3f position;       // world, m
  Frame frame;          // z along the shading normal, on the side that receives
  Vec3f origin;         // where rays from there may start
  int depth = 0;        // surfaces that a path met before it
  int room = 0;         // as ReceivingPlace
  float footprint = 0;  // side of what a pixel sees there, m
};

// What paths of gathered light tell on their way: how far their first surface is.
class FirstDistance : public WithoutPhotons {
 public:
  struct State {
    float* distance = nullptr;  // to be told; null: it has been
  };
  State start(const CameraSample&) const { return {}; }
  void arrive(State& state, float distance) const {
    if (state.distance != nullptr) *state.distance = distance;
    state.distance = nullptr;
  }
  bool ended(const State&) const { return false; }
  void gather(const State&, const PathVertex&, int, const Rgb&, const LightHistory&, SampleResult&) {}
  void scatter(State&, const BsdfSample&) const {}
  float left_of_map(const State&, Vec3f) const { return 1; }
  float left_of_constant(const State&) const { return 1; }
  float left_of_found(const State&, const AreaEmitter&, const SurfacePoint&, Vec3f) const { return 1; }
  float left_of_asked(const State&, const Rgb&, const Emitter&, const EmitterSample&) const { return 1; }
};

class HemisphereSampler {
 public:
  HemisphereSampler(const Scene& scene, RayQueries& queries) : queries_(queries), paths_(scene, {}, queries) {}

  // Of the nearest of the surfaces that a few rays meet, m; infinite if they meet none.
  float least_distance(const GatherPlace& place) const;

  // Fills `grid` with the light that comes to `place` by way of other surfaces, and from a constant environment: what next-event
  // estimation finds at the place itself is left out. Random numbers are those of `seed` and `place_index`.
  void gather(const GatherPlace& place, std::uint64_t seed, int place_index, HemisphereGrid& grid);

 private:
  RayQueries& queries_;
  PathGroup<FirstDistance> paths_;
};

}  // namespace fluxfarm
