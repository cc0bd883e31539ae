// The paths of a block of pixels in a scene with media or null boundaries, traced together step by step, with or without photons
// that carry a part of the light.
#pragma once

#include <array>
#include <limits>
#include <utility>

#include "integrators/light_history.h"
#include "integrators/path/camera_rays.h"
#include "integrators/path/multiple_importance.h"
#include "integrators/path/path_vertex.h"
#include "integrators/path/shadow_rays.h"
#include "integrators/pixel_blocks.h"
#include "integrators/roulette.h"
#include "media/channel_mis.h"
#include "sampling/sampler.h"

namespace fluxfarm {

template <typename PhotonState>
struct VolumePath {
  Rgb throughput{1.0f};
  ChannelMis channels;
  int channel = 0;                            // chooses the distances
  int depth = 0;                              // bounces behind it
  const HomogeneousMedium* medium = nullptr;  // around the ray
  float eta_scale = 1;                        // undoes the radiance scaling of refraction in the roulette's view of the throughput
  // Of the last bounce, against which light that the ray finds is weighted.
  bool delta = true;           // next-event estimation could not have found the last direction
  float direction_pdf = 0;     // of that direction, sr^-1; unused while `delta`
  Vec3f bounce_origin;         // where next-event estimation stood
  EmitterReference reference;  // what it knew of that place
  float bounce_distance = 0;   // from there to the ray's origin through null boundaries, m
  LightHistory history;
  SampleResult* result = nullptr;
  [[no_unique_address]] PhotonState photons = {};
};

// `Photons` as for PathGroup, with what media ask of them.
template <typename Photons>
class VolumePathGroup {
 public:
  VolumePathGroup(const Scene& scene, Photons photons, RayQueries& queries)
      : scene_(scene),
        photons_(std::move(photons)),
        method_(scene.method()),
        max_depth_(method_.max_depth < 0 ? std::numeric_limits<int>::max() : method_.max_depth),
        queries_(queries),
        shadow_rays_(scene, queries) {}

  void trace(std::span<const CameraSample> samples, std::uint64_t seed, std::span<SampleResult> results) {
    start(samples, seed, results);
    for (int step = 0; paths_ > 0; ++step) {
      sampler_.draw_2d(dimension_of(step, kDirection), u_direction_);
      if (!scene_.emitters().empty()) sampler_.draw_2d(dimension_of(step, kEmitterPoint), u_emitter_);
      // Photons are gathered along all of the way to the next surface, wherever the path itself collides.
      if constexpr (!Photons::kInMedia) sample_distances(step);
      queries_.intersect({rays_.data(), paths_}, {hits_.data(), paths_}, step == 0);
      if constexpr (Photons::kInMedia) {
        gather_in_media();
        sample_distances(step);
        for (std::size_t i = 0; i < paths_; ++i) {
          if (!(hits_[i].t < rays_[i].t_max)) hits_[i].shape = Hit::kNone;
        }
      }
      std::size_t alive = 0;
      for (std::size_t i = 0; i < paths_; ++i) {
        // A survivor moves down to the first free place, which is never above its own.
        if (!advance(i, step)) continue;
        if (alive != i) {
          path_[alive] = path_[i];
          rays_[alive] = rays_[i];
          sampler_.move(i, alive);
        }
        ++alive;
      }
      paths_ = alive;
      sampler_.resize(alive);
      shadow_rays_.gather(step == 0);
    }
  }

 private:
  using State = typename Photons::State;
  using Path = VolumePath<State>;

  // Dimensions of a path: the film first, then so many for each step, which ends at a surface, also a null one, or at a collision.
  enum StepDimension : std::uint32_t { kEmitterPoint, kDirection, kEmitterChoice, kLobe, kRoulette, kDistance, kStepDimensions };
  // Counted from the other end, next to the lens, so that it moves no dimension of the steps.
  static constexpr std::uint32_t kChannelDimension = kLensDimension - 1;
  static constexpr std::uint32_t dimension_of(int step, StepDimension use) {
    return 1 + static_cast<std::uint32_t>(step) * kStepDimensions + use;
  }

  void start(std::span<const CameraSample> samples, std::uint64_t seed, std::span<SampleResult> results) {
    start_camera_rays(scene_, samples, seed, sampler_, rays_);
    paths_ = samples.size();
    for (std::size_t i = 0; i < paths_; ++i) {
      results[i] = {};
      path_[i] = Path{};
      path_[i].photons = photons_.start(samples[i]);
      path_[i].medium = scene_.camera_medium();
      path_[i].result = &results[i];
      if (scene_.census().coloured_media)
        path_[i].channel = std::min(static_cast<int>(3 * sampler_.draw_1d(kChannelDimension, i)), 2);
      // Media begin at the near plane, as surfaces do.
      Ray& ray = rays_[i];
      ray = {ray.origin + ray.t_min * ray.direction, ray.direction, 0, ray.t_max - ray.t_min};
    }
  }

  void gather_in_media() {
    for (std::size_t i = 0; i < paths_; ++i) {
      const Path& path = path_[i];
      if (path.medium == nullptr) continue;
      const float length = hits_[i].shape != Hit::kNone ? hits_[i].t : rays_[i].t_max;
      photons_.gather_along(path.photons, {rays_[i].origin, rays_[i].direction, 0, length}, *path.medium, max_depth_ - path.depth,
                            path.throughput, path.history, *path.result);
    }
  }

  void sample_distances(int step) {
    for (std::size_t i = 0; i < paths_; ++i) sample_distance(i, step);
  }

  // Ends the ray at its next collision, if that comes before its own end.
  void sample_distance(std::size_t i, int step) {
    collides_[i] = false;
    const HomogeneousMedium* medium = path_[i].medium;
    if (medium == nullptr) return;
    const float distance = medium->sample_distance(path_[i].channel, sampler_.draw_1d(dimension_of(step, kDistance), i));
    collides_[i] = distance < rays_[i].t_max;
    rays_[i].t_max = std::min(distance, rays_[i].t_max);
  }

  // Takes path i through the end of its ray and leaves its next ray in place of the last. False when the path has ended.
  bool advance(std::size_t i, int step) {
    Path& path = path_[i];
    const Ray& ray = rays_[i];
    const Hit& hit = hits_[i];
    const bool hits = hit.shape != Hit::kNone;
    if (!hits && collides_[i]) return scatter_in_medium(i, step);
    if (path.medium != nullptr) path.throughput *= path.channels.pass(*path.medium, hits ? hit.t : ray.t_max);
    if (path.throughput.is_black()) return false;
    if (!hits) {
      if (shows_emitters(path)) {
        const Rgb found = environment_found(scene_, ray.direction, path.delta, path.direction_pdf,
                                            photons_.left_of_map(path.photons, ray.direction));
        path.result->add(path.throughput * found, path.history.layer());
      }
      return false;
    }
    photons_.arrive(path.photons, hit.t);
    const PathVertex vertex(scene_, ray, hit, bsdf_space_);
    if (vertex.surface->emitter != nullptr && shows_emitters(path)) add_emission(path, vertex, ray, hit);
    const Scene::Boundary& boundary = scene_.boundary(hit.shape);
    if (boundary.invisible) return cross(i, vertex, boundary);
    return scatter_at_surface(i, step, vertex, boundary);
  }

  // Straight on through a null boundary.
  bool cross(std::size_t i, const PathVertex& vertex, const Scene::Boundary& boundary) {
    Path& path = path_[i];
    const Vec3f direction = rays_[i].direction;
    path.bounce_distance += hits_[i].t;
    path.medium = boundary.towards(direction, vertex.point, path.medium);
    rays_[i] = {vertex.origin_towards(direction), direction};
    return true;
  }

  bool scatter_in_medium(std::size_t i, int step) {
    Path& path = path_[i];
    const Ray ray = rays_[i];
    path.throughput *= path.channels.scatter(*path.medium, ray.t_max);
    if (path.throughput.is_black() || path.depth + 1 >= max_depth_) return false;
    photons_.arrive(path.photons, ray.t_max);
    const Vec3f position = ray.origin + ray.t_max * ray.direction;
    const PhaseFunction& phase = path.medium->phase();
    const EmitterReference reference{position, {0, 0, 0}};
    if (const std::optional<LightChoice> light = choose_light(i, step, reference)) {
      const float scattered = phase.value(ray.direction, light->sample.wi);
      const float left = photons_.left_of_asked(path.photons, Rgb{scattered}, *light->emitter, light->sample);
      add_light(i, *light, {position, path.medium, path.history.layer_by_medium()}, Rgb{scattered * left}, scattered);
    }
    const Vec3f direction = phase.sample(ray.direction, u_direction_[i]);
    const float value = phase.value(ray.direction, direction);
    path.reference = reference;
    path.history.scatter_in_medium();
    photons_.scatter_in_medium(path.photons, value);
    return bounce(i, step, {position, direction}, value, false);
  }

  bool scatter_at_surface(std::size_t i, int step, const PathVertex& vertex, const Scene::Boundary& boundary) {
    Path& path = path_[i];
    if (path.depth == 0) note_first_hit(scene_.camera(), vertex, *path.result);
    if (path.depth + 1 >= max_depth_) return false;
    if (vertex.surface->has_continuous_lobe) {
      photons_.gather(path.photons, vertex, max_depth_ - path.depth, path.throughput, path.history, *path.result);
      if (const std::optional<LightChoice> light = choose_light(i, step, vertex.emitter_reference())) {
        const Vec3f wi = vertex.frame.to_local(light->sample.wi);
        const BsdfValue scatter = vertex.bsdf->value(vertex.wo, wi);
        const float left = photons_.left_of_asked(path.photons, scatter.f, *light->emitter, light->sample);
        add_light(i, *light,
                  {vertex.origin_towards(light->sample.wi), boundary.towards(light->sample.wi, vertex.point, path.medium),
                   path.history.layer_by_surface()},
                  scatter.f * (std::fabs(wi.z) * left), scatter.pdf);
      }
    }
    const float u_lobe = vertex.surface->chooses_lobe ? sampler_.draw_1d(dimension_of(step, kLobe), i) : 0.0f;
    const std::optional<BsdfSample> scatter = vertex.bsdf->sample(vertex.wo, u_lobe, u_direction_[i]);
    if (!scatter) return false;
    path.throughput *= scatter->weight;
    path.eta_scale *= scatter->eta * scatter->eta;
    if (path.throughput.is_black()) return false;
    const Vec3f direction = vertex.frame.to_world(scatter->wi);
    path.medium = boundary.towards(direction, vertex.point, path.medium);
    path.reference = vertex.emitter_reference();
    path.history.scatter_at_surface(*scatter);
    photons_.scatter(path.photons, *scatter);
    return bounce(i, step, {vertex.origin_towards(direction), direction}, scatter->pdf, scatter->delta);
  }

  // Lets the path go on along `ray`, or ends it by Russian roulette.
  bool bounce(std::size_t i, int step, const Ray& ray, float direction_pdf, bool delta) {
    Path& path = path_[i];
    path.direction_pdf = direction_pdf;
    path.delta = delta;
    path.bounce_origin = ray.origin;
    path.bounce_distance = 0;
    rays_[i] = ray;
    if (++path.depth < method_.rr_depth) return true;
    const float survival = std::min(max_component(path.throughput) * path.eta_scale, kMaxSurvival);
    if (sampler_.draw_1d(dimension_of(step, kRoulette), i) >= survival) return false;
    path.throughput *= 1 / survival;
    return true;
  }

  bool shows_emitters(const Path& path) const { return path.depth > 0 || !method_.hide_emitters; }

  // Emission found by the last bounce, weighted against next-event estimation from there, which could have found it, too. The
  // weights leave out the chance of getting there without a collision, for both alike.
  void add_emission(const Path& path, const PathVertex& vertex, const Ray& ray, const Hit& hit) const {
    const Rgb emitted = vertex.surface->emitter->radiance(vertex.point, ray.direction);
    if (emitted.is_black()) return;
    float weight = photons_.left_of_found(path.photons, *vertex.surface->emitter, vertex.point, ray.direction);
    if (!path.delta) {
      const Ray from_bounce{path.bounce_origin, ray.direction};
      Hit seen = hit;
      seen.t += path.bounce_distance;
      const float pdf = scene_.emitters().pdf(vertex.surface->emitter_index, path.reference, {vertex.point, seen, from_bounce});
      weight *= power_heuristic(path.direction_pdf, pdf);
    }
    path.result->add(path.throughput * emitted * weight, path.history.layer());
  }

  // Next-event estimation: one emitter, one point of it.
  struct LightChoice {
    EmitterSample sample;
    const Emitter* emitter;
    float probability;  // of it
  };
  std::optional<LightChoice> choose_light(std::size_t i, int step, const EmitterReference& reference) const {
    const EmitterChoice& emitters = scene_.emitters();
    if (emitters.empty()) return std::nullopt;
    const float u_choice = emitters.single() ? 0.0f : sampler_.draw_1d(dimension_of(step, kEmitterChoice), i);
    const std::optional<EmitterChoice::Choice> choice = emitters.sample(reference, u_choice);
    if (!choice) return std::nullopt;
    const std::optional<EmitterSample> sample = choice->emitter->sample(reference.position, u_emitter_[i]);
    if (!sample) return std::nullopt;
    return LightChoice{*sample, choice->emitter, choice->probability};
  }

  // Where light is scattered into the path.
  struct Arrival {
    Vec3f origin;  // of the shadow ray
    const HomogeneousMedium* medium;
    LightLayer layer;
  };
  // `scattered`: phase function, or BSDF times cosine, towards the light, sr^-1; `pdf`: of sampling it there, sr^-1.
  void add_light(std::size_t i, const LightChoice& light, const Arrival& at, Rgb scattered, float pdf) {
    if (scattered.is_black()) return;
    const std::optional<Ray> ray = shadow_ray(at.origin, light.sample);
    if (!ray) return;
    const float weight = light.sample.delta ? 1.0f : power_heuristic(light.sample.pdf_solid_angle * light.probability, pdf);
    const Rgb arriving = scattered * light.sample.weight * (weight / light.probability);
    shadow_rays_.add(*ray, {path_[i].throughput * arriving, at.layer, at.medium, path_[i].result});
  }

  const Scene& scene_;
  [[no_unique_address]] Photons photons_;
  const MethodDescription& method_;
  const int max_depth_;
  RayQueries& queries_;
  ShadowRays shadow_rays_;

  std::size_t paths_ = 0;  // alive; the first so many entries of the arrays below
  SamplerBatch sampler_;
  std::array<Vec2f, kMaxPaths> u_direction_, u_emitter_;
  std::array<Path, kMaxPaths> path_;
  std::array<Ray, kMaxPaths> rays_;
  std::array<bool, kMaxPaths> collides_;  // unless the ray meets a surface before its end
  std::array<Hit, kMaxPaths> hits_;
  BsdfSpace bsdf_space_;  // of the vertex at hand
};

}  // namespace fluxfarm
