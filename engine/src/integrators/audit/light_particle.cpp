#include "integrators/audit/light_particle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "integrators/audit/key_random.h"
#include "integrators/path/path_vertex.h"
#include "integrators/roulette.h"

namespace fluxfarm {
namespace {

DiscreteDistribution choice_of(const std::vector<const Emitter*>& emitters) {
  std::vector<double> weights;
  double total = 0;
  for (const Emitter* emitter : emitters) {
    const auto power = static_cast<double>(mean(emitter->power()));
    total += weights.emplace_back(std::isfinite(power) ? power : 0.0);  // what is beyond all numbers cannot be followed
  }
  for (double& weight : weights) weight = weight > 0 ? 0.5 * weight / total + 0.5 / static_cast<double>(weights.size()) : 0.0;
  return DiscreteDistribution(weights);
}

// What is left of flux that arrived from `from` (world) and was scattered as `s` says, towards `towards` (world). A BSDF describes
// the scattering of radiance, which comes to a path from where the flux goes: its directions are exchanged, and with them the
// scaling by refraction. Around a shading normal the cosines that the two leave out differ.              [Veach97, section 5.3.2]
//
// A delta lobe has no value to ask for. It is taken to scatter both ways alike, up to the scaling by refraction, which holds but
// for those under a normal map: they miss the ratio of the cosines to the shading normal.
Rgb scattered_flux(const PathVertex& vertex, Vec3f from, Vec3f towards, const BsdfSample& s) {
  const float arriving = std::fabs(dot(from, vertex.point.geometric_normal));
  const float leaving = std::fabs(dot(towards, vertex.point.geometric_normal));
  if (!(arriving > 0)) return {};
  const float cosines = std::fabs(vertex.wo.z) * leaving / arriving;
  if (!s.delta) return vertex.bsdf->value(s.wi, vertex.wo).f * (cosines / s.pdf);
  const float cos_leaving = std::fabs(s.wi.z);
  return cos_leaving > 0 ? s.weight * (s.eta * s.eta * cosines / cos_leaving) : Rgb{};
}

}  // namespace

struct ParticleTracer::Particle {
  Rgb flux;
  Ray ray;
  bool delta_emitter = false;
  bool unreachable = false;
  KeyRandom random;
};

ParticleTracer::ParticleTracer(const Scene& scene, std::uint64_t seed, std::uint32_t particles)
    : scene_(scene),
      seed_(seed),
      particles_(particles),
      max_depth_(scene.method().max_depth < 0 ? std::numeric_limits<int>::max() : scene.method().max_depth),
      choice_(choice_of(scene.emitter_list())) {}

void ParticleTracer::trace(std::uint32_t index, RayQueries& queries, ParticleTrace& trace) const {
  trace.clear();
  KeyRandom random(seed_, KeyRandom::kParticle, index);
  const double place = (index + static_cast<double>(random.next_1d())) / particles_;
  const DiscreteDistribution::Choice choice = choice_.sample(std::min(static_cast<float>(place), 0x1.fffffep-1f));
  const Vec2f u_point = random.next_2d(), u_direction = random.next_2d();
  const auto emission = scene_.emitter_list()[choice.index]->emit(u_point, u_direction, scene_.center());
  if (!emission) return;
  Particle particle{emission->flux / choice.probability, emission->ray, emission->delta, false, random};
  const float begun_with = max_component(particle.flux);
  if (!(begun_with > 0) || !is_finite(particle.flux)) return;

  BsdfSpace space;
  // Paths have `bounces` surfaces between the emitter and the camera.
  for (int bounces = 1; bounces < max_depth_; ++bounces) {
    Hit hit;
    queries.intersect({&particle.ray, 1}, {&hit, 1}, false);
    if (hit.shape == Hit::kNone) return;
    const PathVertex vertex(scene_, particle.ray, hit, space);
    if (vertex.surface->has_continuous_lobe) {
      const auto arriving = static_cast<double>(mean(particle.flux));
      trace.arrived += arriving;
      if (particle.unreachable) trace.arrived_unreachable += arriving;
      connect(vertex, particle, queries, trace);
    }

    const float u_lobe = particle.random.next_1d();
    const std::optional<BsdfSample> scatter = vertex.bsdf->sample(vertex.wo, u_lobe, particle.random.next_2d());
    if (!scatter) return;
    // Next-event estimation alone finds a delta light, and never over a delta lobe.
    if (bounces == 1 && particle.delta_emitter && scatter->delta) particle.unreachable = true;
    const Vec3f direction = vertex.frame.to_world(scatter->wi);
    particle.flux *= scattered_flux(vertex, -particle.ray.direction, direction, *scatter);
    if (!is_finite(particle.flux)) return;
    const float survival = std::min(max_component(particle.flux) / begun_with, kMaxSurvival);
    if (!(particle.random.next_1d() < survival)) return;
    particle.flux *= 1 / survival;
    particle.ray = {vertex.origin_towards(direction), direction};
  }
}

// The flux at a surface, over its area, is irradiance; scattered towards the camera it is radiance there.
void ParticleTracer::connect(const PathVertex& vertex, Particle& particle, RayQueries& queries, ParticleTrace& trace) const {
  const Vec2f u_lens = particle.random.next_2d(), u_filter = particle.random.next_2d();
  const std::optional<Camera::Projection> seen = scene_.camera().project(vertex.point.position, u_lens);
  if (!seen) return;
  const Vec2f offset = scene_.pixel_filter().sample(u_filter);
  const float x = seen->x - offset.x, y = seen->y - offset.y;
  if (!(x >= 0 && y >= 0 && x < static_cast<float>(scene_.film().width) && y < static_cast<float>(scene_.film().height))) return;

  const Vec3f to_lens = normalize(seen->lens - vertex.point.position);
  // The surface scatters light from where the particle came (local: vertex.wo) to the camera.
  const Rgb f = vertex.bsdf->value(vertex.frame.to_local(to_lens), vertex.wo).f;
  if (f.is_black()) return;
  const float cos_arriving = std::fabs(dot(particle.ray.direction, vertex.point.geometric_normal));
  if (!(cos_arriving > 0)) return;
  const float cosines = std::fabs(vertex.wo.z) / cos_arriving * std::fabs(dot(to_lens, vertex.point.geometric_normal));
  const float radiance = mean(f * particle.flux) * cosines * seen->pixels_per_area;
  if (!(radiance > 0) || !std::isfinite(radiance)) return;

  const Vec3f origin = vertex.origin_towards(to_lens);
  const float distance = length(seen->lens - origin);
  const Ray ray{origin, (seen->lens - origin) / distance, 0, distance * (1 - std::max(seen->near, 1e-5f))};
  bool occluded = false;
  queries.occluded({&ray, 1}, {&occluded, 1}, false);
  if (!occluded) trace.splats.push_back({x, y, radiance, particle.unreachable});
}

}  // namespace fluxfarm
