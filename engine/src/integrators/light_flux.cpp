#include "integrators/light_flux.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sampling/warp.h"

namespace fluxfarm {
namespace {

// What is left of flux that arrived from `from` (world) and was scattered as `s` says, towards `towards` (world). A BSDF describes
// the scattering of radiance, which comes to a path from where the flux goes: its directions are exchanged, and with them the
// scaling by refraction. Around a shading normal the cosines that the two leave out differ.              [Veach97, section 5.3.2]
//
// A delta lobe has no value to ask for. It is taken to scatter both ways alike, up to the scaling by refraction, which holds but
// for those under a normal map: they miss the ratio of the cosines to the shading normal.
ScatteredFlux scattered(const PathVertex& vertex, Vec3f from, Vec3f towards, const BsdfSample& s) {
  ScatteredFlux scattered{towards, {}, std::numeric_limits<float>::infinity(), s.delta, s.passes};
  const float arriving = std::fabs(dot(from, vertex.point.geometric_normal));
  const float leaving = std::fabs(dot(towards, vertex.point.geometric_normal));
  if (!(arriving > 0)) return scattered;
  const float cosines = std::fabs(vertex.wo.z) * leaving / arriving;
  if (!s.delta) {
    const Rgb f = vertex.bsdf->value(s.wi, vertex.wo).f;
    scattered.share = f * (cosines / s.pdf);
    scattered.value = max_component(f);
    return scattered;
  }
  const float cos_leaving = std::fabs(s.wi.z);
  if (cos_leaving > 0) scattered.share = s.weight * (s.eta * s.eta * cosines / cos_leaving);
  return scattered;
}

// The constant environment: every direction alike.
EmissionSample emit_environment(const Scene& scene, Vec2f u_point, Vec2f u_direction) {
  const Rgb irradiance = *scene.environment() * (4 * kPi);  // summed over all directions
  return emitted_from_outside(square_to_uniform_sphere(u_direction), irradiance, 4 * kPi, scene.center(), scene.radius(), u_point);
}

}  // namespace

std::vector<double> ParticleSource::powers(const Scene& scene) {
  std::vector<double> powers;
  const auto add = [&](Rgb power) {
    const auto value = static_cast<double>(mean(power));
    powers.push_back(std::isfinite(value) ? value : 0.0);
  };
  for (const Emitter* emitter : scene.emitter_list()) add(emitter->power());
  if (scene.environment()) add(*scene.environment() * (4 * kPi * kPi * sqr(scene.radius())));
  return powers;
}

std::optional<EmissionSample> ParticleSource::emit_from(const Scene& scene, std::size_t emitter, Vec2f u_point, Vec2f u_direction) {
  const std::vector<const Emitter*>& emitters = scene.emitter_list();
  if (emitter < emitters.size()) return emitters[emitter]->emit(u_point, u_direction, scene.center());
  return emit_environment(scene, u_point, u_direction);
}

EmissionBounds ParticleSource::bounds(const Scene& scene, std::size_t emitter, const EmissionCell& cell) {
  const std::vector<const Emitter*>& emitters = scene.emitter_list();
  if (emitter < emitters.size()) return emitters[emitter]->emission_bounds(cell, scene.center());
  return bounds_emitted_from_outside(cap_cone(cell.direction, 2), scene.center(), scene.radius(), cell.point);
}

std::optional<EmissionSample> ParticleSource::emit(double place, Vec2f u_point, Vec2f u_direction) const {
  const DiscreteDistribution::Choice choice = choice_.sample(std::min(static_cast<float>(place), 0x1.fffffep-1f));
  std::optional<EmissionSample> emission = emit_from(scene_, choice.index, u_point, u_direction);
  if (emission) emission->flux = emission->flux / choice.probability;
  return emission;
}

std::optional<ScatteredFlux> scatter_flux(const PathVertex& vertex, Vec3f from, KeyRandom& random) {
  const float u_lobe = random.next_1d();
  const std::optional<BsdfSample> s = vertex.bsdf->sample(vertex.wo, u_lobe, random.next_2d());
  if (!s) return std::nullopt;
  return scattered(vertex, from, vertex.frame.to_world(s->wi), *s);
}

}  // namespace fluxfarm
