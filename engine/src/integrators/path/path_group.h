// The paths of a block of pixels, traced together bounce by bounce, with or without photons that carry a part of the light.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <utility>

#include "integrators/light_history.h"
#include "integrators/path/camera_rays.h"
#include "integrators/path/multiple_importance.h"
#include "integrators/path/path_vertex.h"
#include "integrators/pixel_blocks.h"
#include "integrators/roulette.h"

namespace fluxfarm {

// Dimensions of a path: the film first, then so many for each bounce.
enum BounceDimension : std::uint32_t { kEmitterPoint, kDirection, kEmitterChoice, kLobe, kRoulette, kBounceDimensions };
constexpr std::uint32_t dimension_of(int depth, BounceDimension use) {
  return 1 + static_cast<std::uint32_t>(depth) * kBounceDimensions + use;
}

template <typename PhotonState>
struct Path {
  Rgb throughput{1.0f};
  float eta_scale = 1;  // undoes the radiance scaling of refraction in the roulette's view of the throughput
  float bsdf_pdf = 0;   // of the last direction; unused while `delta`
  bool delta = true;    // next-event estimation could not have found the last direction
  LightHistory history = {};
  SampleResult* result = nullptr;
  [[no_unique_address]] PhotonState photons = {};
};

// Light on its way to a path, if the shadow ray of the same index gets through.
struct PendingLight {
  Rgb radiance;
  LightLayer layer = LightLayer::kDirect;
  SampleResult* result = nullptr;
};

// What a group of paths asks of photons when there are none.
class WithoutPhotons {
 public:
  static constexpr bool kInMedia = false;  // whether gather_along() may find any
  // What each path carries.
  struct State {};
  State start(const CameraSample&) const { return {}; }
  void arrive(State&, float) const {}
  bool ended(const State&) const { return false; }  // the path sees what emits where it is, and no more
  void gather(const State&, const PathVertex&, int, const Rgb&, const LightHistory&, SampleResult&) {}
  void gather_along(const State&, const Ray&, const HomogeneousMedium&, int, const Rgb&, const LightHistory&, SampleResult&) {}
  void scatter(State&, const BsdfSample&) const {}
  void scatter_in_medium(State&, float) const {}
  // Parts that they leave to the path.
  float left_of_map(const State&, Vec3f) const { return 1; }
  float left_of_constant(const State&) const { return 1; }
  float left_of_found(const State&, const AreaEmitter&, const SurfacePoint&, Vec3f) const { return 1; }
  float left_of_asked(const State&, const Rgb&, const Emitter&, const EmitterSample&) const { return 1; }
};

template <typename Photons>
class PathGroup {
 public:
  PathGroup(const Scene& scene, Photons photons, RayQueries& queries)
      : scene_(scene),
        photons_(std::move(photons)),
        method_(scene.method()),
        max_depth_(method_.max_depth < 0 ? std::numeric_limits<int>::max() : method_.max_depth),
        queries_(queries) {}

  void trace(std::span<const CameraSample> samples, std::uint64_t seed, std::span<SampleResult> results) {
    start(samples, seed, results);
    follow(0);
  }

  // Light that comes by way of other surfaces to a diffuse one, which is the `depth`-th on the way, along `rays` that start there.
  // What next-event estimation would find there, as `reference` says, is left out. `sampler` holds the rays' samples, `results` are
  // added to.
  void trace_gathered(std::span<const Ray> rays, std::span<const typename Photons::State> states, const EmitterReference& reference,
                      int depth, const SamplerBatch& sampler, std::span<SampleResult> results) {
    sampler_ = sampler;
    paths_ = rays.size();
    BsdfSample diffuse;
    LightHistory history;
    history.scatter_at_surface(diffuse);
    for (std::size_t i = 0; i < paths_; ++i) {
      rays_[i] = rays[i];
      references_[i] = reference;
      path_[i] = {.bsdf_pdf = 0, .delta = false, .history = history, .result = &results[i], .photons = states[i]};
    }
    follow(depth);
  }

 private:
  // From the depth-th surface on, counting from 0.
  void follow(int depth) {
    for (; paths_ > 0; ++depth) {
      sampler_.draw_2d(dimension_of(depth, kDirection), u_direction_);
      if (!scene_.emitters().empty()) sampler_.draw_2d(dimension_of(depth, kEmitterPoint), u_emitter_);
      queries_.intersect({rays_.data(), paths_}, {hits_.data(), paths_}, depth == 0);
      // All vertices first: they do not depend on each other, so the waits for their memory overlap. Made in place: copying what
      // has just been written number by number stalls.
      for (std::size_t i = 0; i < paths_; ++i) {
        if (hits_[i].shape != Hit::kNone) std::construct_at(&vertices_[i], scene_, rays_[i], hits_[i], bsdf_spaces_[i]);
      }
      std::size_t alive = 0;
      lights_ = 0;
      for (std::size_t i = 0; i < paths_; ++i) {
        // A survivor moves down to the first free place, which is never above its own.
        if (!advance(i, depth)) continue;
        if (alive != i) {
          path_[alive] = path_[i];
          rays_[alive] = rays_[i];
          if (scene_.emitters().by_place()) references_[alive] = references_[i];
          sampler_.move(i, alive);
        }
        ++alive;
      }
      paths_ = alive;
      sampler_.resize(alive);
      gather_lights(depth == 0);
    }
  }

  void start(std::span<const CameraSample> samples, std::uint64_t seed, std::span<SampleResult> results) {
    start_camera_rays(scene_, samples, seed, sampler_, rays_);
    paths_ = samples.size();
    for (std::size_t i = 0; i < paths_; ++i) {
      results[i] = {};
      path_[i] = {.result = &results[i], .photons = photons_.start(samples[i])};
    }
  }

  // Takes path i through its next vertex and leaves its next ray in place of the last. False when the path has ended.
  bool advance(std::size_t i, int depth) {
    Path<State>& path = path_[i];
    Ray& ray = rays_[i];
    const Hit& hit = hits_[i];
    const bool shows_emitters = depth > 0 || !method_.hide_emitters;
    if (hit.shape == Hit::kNone) {
      if (shows_emitters) {
        const Rgb found =
            environment_found(scene_, ray.direction, path.delta, path.bsdf_pdf, photons_.left_of_map(path.photons, ray.direction),
                              photons_.left_of_constant(path.photons));
        path.result->add(path.throughput * found, path.history.layer());
      }
      return false;
    }
    const PathVertex& vertex = vertices_[i];
    photons_.arrive(path.photons, hit.t);
    if (depth == 0) note_first_hit(scene_.camera(), vertex, *path.result);
    if (vertex.surface->emitter != nullptr && shows_emitters) add_emission(i, vertex);
    if (depth + 1 >= max_depth_ || photons_.ended(path.photons)) return false;
    if (vertex.surface->has_continuous_lobe) {
      photons_.gather(path.photons, vertex, max_depth_ - depth, path.throughput, path.history, *path.result);
    }
    if (vertex.surface->has_continuous_lobe && !scene_.emitters().empty()) sample_light(i, depth, vertex);

    const float u_lobe = vertex.surface->chooses_lobe ? sampler_.draw_1d(dimension_of(depth, kLobe), i) : 0.0f;
    const std::optional<BsdfSample> scatter = vertex.bsdf->sample(vertex.wo, u_lobe, u_direction_[i]);
    if (!scatter) return false;
    path.throughput *= scatter->weight;
    path.eta_scale *= scatter->eta * scatter->eta;
    path.bsdf_pdf = scatter->pdf;
    path.delta = scatter->delta;
    path.history.scatter_at_surface(*scatter);
    photons_.scatter(path.photons, *scatter);
    if (path.throughput.is_black()) return false;
    if (depth + 1 >= method_.rr_depth && !survives(i, depth)) return false;
    const Vec3f direction = vertex.frame.to_world(scatter->wi);
    ray = {vertex.origin_towards(direction), direction};
    if (scene_.emitters().by_place()) references_[i] = vertex.emitter_reference();
    return true;
  }

  // Emission found by BSDF sampling, weighted against next-event estimation, which could have found it, too.
  void add_emission(std::size_t i, const PathVertex& vertex) {
    const Path<State>& path = path_[i];
    const Ray& ray = rays_[i];
    const Rgb emitted = vertex.surface->emitter->radiance(vertex.point, ray.direction);
    if (emitted.is_black()) return;
    float weight = photons_.left_of_found(path.photons, *vertex.surface->emitter, vertex.point, ray.direction);
    if (!path.delta) {
      const float pdf = scene_.emitters().pdf(vertex.surface->emitter_index, references_[i], {vertex.point, hits_[i], ray});
      weight *= power_heuristic(path.bsdf_pdf, pdf);
    }
    path.result->add(path.throughput * emitted * weight, path.history.layer());
  }

  // Next-event estimation: one emitter, one point of it. Leaves a shadow ray and the light that it stands for.
  void sample_light(std::size_t i, int depth, const PathVertex& vertex) {
    const EmitterChoice& emitters = scene_.emitters();
    const float u_choice = emitters.single() ? 0.0f : sampler_.draw_1d(dimension_of(depth, kEmitterChoice), i);
    const std::optional<EmitterChoice::Choice> choice = emitters.sample(vertex.emitter_reference(), u_choice);
    if (!choice) return;
    const std::optional<EmitterSample> light = choice->emitter->sample(vertex.point.position, u_emitter_[i]);
    if (!light) return;
    const Vec3f wi = vertex.frame.to_local(light->wi);
    const BsdfValue scatter = vertex.bsdf->value(vertex.wo, wi);
    if (scatter.f.is_black()) return;

    const std::optional<Ray> shadow = shadow_ray(vertex.origin_towards(light->wi), *light);
    if (!shadow) return;
    shadow_rays_[lights_] = *shadow;
    float weight = photons_.left_of_asked(path_[i].photons, scatter.f, *choice->emitter, *light);
    if (!light->delta) weight *= power_heuristic(light->pdf_solid_angle * choice->probability, scatter.pdf);
    const Rgb arriving = scatter.f * light->weight * (std::fabs(wi.z) * weight / choice->probability);
    pending_[lights_++] = {path_[i].throughput * arriving, path_[i].history.layer_by_surface(), path_[i].result};
  }

  void gather_lights(bool coherent) {
    queries_.occluded({shadow_rays_.data(), lights_}, {occluded_.data(), lights_}, coherent);
    for (std::size_t i = 0; i < lights_; ++i) {
      if (!occluded_[i]) pending_[i].result->add(pending_[i].radiance, pending_[i].layer);
    }
  }

  // Russian roulette by throughput.
  bool survives(std::size_t i, int depth) {
    Path<State>& path = path_[i];
    const float survival = std::min(max_component(path.throughput) * path.eta_scale, kMaxSurvival);
    if (sampler_.draw_1d(dimension_of(depth, kRoulette), i) >= survival) return false;
    path.throughput *= 1 / survival;
    return true;
  }

  using State = typename Photons::State;

  const Scene& scene_;
  [[no_unique_address]] Photons photons_;
  const MethodDescription& method_;
  const int max_depth_;
  RayQueries& queries_;

  std::size_t paths_ = 0;  // alive; the first so many entries of the arrays below
  SamplerBatch sampler_;
  std::array<Vec2f, kMaxPaths> u_direction_, u_emitter_;
  std::array<Path<State>, kMaxPaths> path_;
  std::array<Ray, kMaxPaths> rays_;
  std::array<EmitterReference, kMaxPaths> references_;  // where each ray comes from, if the choice of emitters asks for it
  std::array<Hit, kMaxPaths> hits_;
  std::array<PathVertex, kMaxPaths> vertices_;
  std::array<BsdfSpace, kMaxPaths> bsdf_spaces_;  // of vertices with textures
  std::size_t lights_ = 0;
  std::array<Ray, kMaxPaths> shadow_rays_;
  std::array<PendingLight, kMaxPaths> pending_;
  std::array<bool, kMaxPaths> occluded_;
};

}  // namespace fluxfarm
