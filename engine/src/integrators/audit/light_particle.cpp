#include "integrators/audit/light_particle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "integrators/key_random.h"
#include "integrators/path/path_vertex.h"
#include "integrators/photon/sharpness.h"
#include "integrators/roulette.h"

namespace fluxfarm {
namespace {

// Half evenly, half in proportion to power.
std::vector<double> shares_of(const Scene& scene) {
  std::vector<double> weights = ParticleSource::powers(scene);
  weights.resize(scene.emitter_list().size());  // without the constant environment
  double total = 0;
  for (const double weight : weights) total += weight;
  for (double& weight : weights) weight = weight > 0 ? 0.5 * weight / total + 0.5 / static_cast<double>(weights.size()) : 0.0;
  return weights;
}

}  // namespace

// Light as a path from the camera would bring it back that goes the particle's way and asks for the emitter in the end.
class FoundLight {
 public:
  explicit FoundLight(const EmissionSample& emission)
      : size_(emission.size), from_outside_(emission.from_outside), radiance_(mean(emission.intensity)) {}

  void travel(float distance) { travelled_ += distance; }
  // Scattered, with so much of the light left.
  void scatter(const ScatteredFlux& scatter, float left) {
    if (scatter.passes) return;
    if (first_) {
      // A lobe that is narrower than the emitter looks shows its radiance, a wider one spreads what arrives.
      const float irradiance = from_outside_ ? radiance_ : radiance_ / (travelled_ * travelled_);
      const float size = size_.from(travelled_);
      radiance_ = std::isinf(scatter.value) || scatter.value * size > 1 ? irradiance / size : irradiance * scatter.value;
      sharp_so_far_ = sharpness(1 / scatter.value + size);
      if (!std::isfinite(radiance_)) radiance_ = 0;  // no path finds it
    } else {
      const float sharp = sharpness(1 / scatter.value);
      by_photons_ += sharp_so_far_ * (1 - sharp);
      sharp_so_far_ *= sharp;
    }
    radiance_ *= left;
    first_ = false;
  }

  // Of the surface that a path comes from; mean over R, G, B, W m^-2 sr^-1.
  float radiance() const { return first_ ? 0 : radiance_; }
  // The part of it that photons would carry (photon/sharpness.h).
  float by_photons() const { return by_photons_ + sharp_so_far_; }

 private:
  ApparentSize size_;  // of the emitter
  bool from_outside_;
  float radiance_;       // before it is scattered, EmissionSample::intensity
  float travelled_ = 0;  // since emission, m
  float sharp_so_far_ = 0, by_photons_ = 0;
  bool first_ = true;  // not scattered so far
};

struct ParticleTracer::Particle {
  Rgb flux;
  Ray ray;
  bool delta_emitter = false;
  bool unreachable = false;
  FoundLight found;
  KeyRandom random;
};

ParticleTracer::ParticleTracer(const Scene& scene, std::uint64_t seed, std::uint32_t particles, bool finds_caustics)
    : scene_(scene),
      seed_(seed),
      particles_(particles),
      finds_caustics_(finds_caustics),
      max_depth_(scene.method().max_depth < 0 ? std::numeric_limits<int>::max() : scene.method().max_depth),
      source_(scene, shares_of(scene)) {}

void ParticleTracer::trace(std::uint32_t index, RayQueries& queries, ParticleTrace& trace) const {
  trace.clear();
  KeyRandom random(seed_, KeyRandom::kParticle, index);
  const double place = (index + static_cast<double>(random.next_1d())) / particles_;
  const Vec2f u_point = random.next_2d(), u_direction = random.next_2d();
  const auto emission = source_.emit(place, u_point, u_direction);
  if (!emission) return;
  Particle particle{emission->flux, emission->ray, emission->delta, false, FoundLight(*emission), random};
  const float begun_with = max_component(particle.flux);
  if (!(begun_with > 0) || !is_finite(particle.flux)) return;

  BsdfSpace space;
  // Paths have `bounces` surfaces between the emitter and the camera.
  for (int bounces = 1; bounces < max_depth_; ++bounces) {
    Hit hit;
    queries.intersect({&particle.ray, 1}, {&hit, 1}, false);
    if (hit.shape == Hit::kNone) return;
    const PathVertex vertex(scene_, particle.ray, hit, space);
    particle.found.travel(hit.t);
    if (vertex.surface->has_continuous_lobe) {
      const auto arriving = static_cast<double>(mean(particle.flux));
      trace.arrived += arriving;
      if (particle.unreachable) trace.arrived_unreachable += arriving;
      if (const auto found = static_cast<double>(particle.found.radiance()); found > 0) {
        const double rare = arriving * static_cast<double>(particle.found.by_photons());
        trace.arrived_rare += rare;
        trace.arrived_bright += rare * found;
      }
      connect(vertex, particle, queries, trace);
    }

    const std::optional<ScatteredFlux> scatter = scatter_flux(vertex, -particle.ray.direction, particle.random);
    if (!scatter) return;
    // Of paths next-event estimation alone finds a delta light, and never over a delta lobe.
    if (bounces == 1 && particle.delta_emitter && scatter->delta && !finds_caustics_) particle.unreachable = true;
    particle.flux *= scatter->share;
    particle.found.scatter(*scatter, mean(scatter->share));
    if (!is_finite(particle.flux)) return;
    const float survival = std::min(max_component(particle.flux) / begun_with, kMaxSurvival);
    if (!(particle.random.next_1d() < survival)) return;
    particle.flux *= 1 / survival;
    particle.ray = {vertex.origin_towards(scatter->direction), scatter->direction};
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
  if (occluded) return;
  const float albedo = std::min(mean(f) * kPi, 1.0f);  // of a diffuse surface
  const float found = albedo * particle.found.radiance() * particle.found.by_photons();
  trace.splats.push_back({x, y, radiance, particle.unreachable, static_cast<double>(radiance) * static_cast<double>(found)});
}

}  // namespace fluxfarm
