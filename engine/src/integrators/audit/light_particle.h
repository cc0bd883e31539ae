// One particle of light, followed from its emitter through the scene: at each surface with a continuous lobe it is connected to the
// camera, which makes it an estimate of the picture from the other side than path tracing.
#pragma once

#include <cstdint>
#include <vector>

#include "accel/ray_queries.h"
#include "integrators/light_flux.h"
#include "scene/scene.h"

namespace fluxfarm {

struct PathVertex;

// What a particle adds to the film where the camera sees it.
struct Splat {
  float x, y;        // in pixels from the film's top left corner
  float radiance;    // mean over R, G, B, summed over the pixels: divide by the number of particles and pixels. W m^-2 sr^-1
  bool unreachable;  // the method cannot find this light
  // Of light that was scattered sharply, what a path that finds it brings back times `radiance`: divide in the same way.
  double sharp_square;
};

struct ParticleTrace {
  std::vector<Splat> splats;
  // Flux that arrived at surfaces with a continuous lobe, mean over R, G, B, at all bounces; and of it what no path from the camera
  // can find there. W
  double arrived = 0, arrived_unreachable = 0;
  // Of it what was scattered sharply and paths may find, W, and that times the radiance which they find it by.
  double arrived_rare = 0, arrived_bright = 0;

  void clear() {
    splats.clear();
    arrived = arrived_unreachable = arrived_rare = arrived_bright = 0;
  }
};

class ParticleTracer {
 public:
  // Emitters are chosen half evenly, half in proportion to power: dim ones count where they alone shine.
  ParticleTracer(const Scene& scene, std::uint64_t seed, std::uint32_t particles, bool finds_caustics);

  // Follows particle `index` of so many. The result depends on the scene, the seed and the index alone. Safe to call from many
  // threads, each with its own queries.
  void trace(std::uint32_t index, RayQueries& queries, ParticleTrace& trace) const;

 private:
  struct Particle;
  void connect(const PathVertex& vertex, Particle& particle, RayQueries& queries, ParticleTrace& trace) const;

  const Scene& scene_;
  const std::uint64_t seed_;
  const std::uint32_t particles_;
  const bool finds_caustics_;
  const int max_depth_;
  ParticleSource source_;
};

}  // namespace fluxfarm
