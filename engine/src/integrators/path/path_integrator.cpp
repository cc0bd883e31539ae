#include "integrators/path/path_integrator.h"

#include <limits>

#include "math/frame.h"

namespace fluxfarm {
namespace {

// Power heuristic with exponent two for one sample of each of two techniques.                      [Veach97, section 9.2.4]
float power_heuristic(float pdf, float other_pdf) {
  if (!(pdf > 0)) return 0;
  const float ratio = other_pdf / pdf;
  return 1 / (1 + ratio * ratio);
}

// The part of a shadow ray or of a path that a hit needs.
struct Vertex {
  const Scene::Surface& surface;
  SurfacePoint point;
  Frame frame;
  Vec3f wo;  // local

  Vertex(const Scene& scene, const Ray& ray, const Hit& hit) : surface(scene.surface(hit.shape)) {
    point = surface.shape->surface_point(ray, hit);
    frame = Frame(point.shading_normal);
    if (surface.anisotropic) align(surface.shape->tangent(point, hit));
    wo = frame.to_local(-ray.direction);
  }

  // Where a ray towards `direction` (world) may start without meeting its own surface.
  Vec3f origin_towards(Vec3f direction) const {
    const Vec3f n = point.geometric_normal;
    return offset_point(point.position, dot(n, direction) >= 0 ? n : -n);
  }

 private:
  void align(Vec3f tangent) {
    const Vec3f s = tangent - dot(tangent, frame.n) * frame.n;
    const float squared = length_squared(s);
    if (!(squared > 0)) return;
    frame.s = s / std::sqrt(squared);
    frame.t = cross(frame.n, frame.s);
  }
};

// Light from one emitter, chosen and sampled, that `vertex` scatters back along the path. Zero if something is in between.
Rgb direct_light(const Scene& scene, const Vertex& vertex, Sampler& sampler, RayQueries& queries) {
  const EmitterChoice& emitters = scene.emitters();
  const EmitterChoice::Choice choice = emitters.sample(emitters.single() ? 0.0f : sampler.next_1d());
  const std::optional<EmitterSample> light = choice.emitter->sample(vertex.point.position, sampler.next_2d());
  if (!light) return {};
  const Vec3f wi = vertex.frame.to_local(light->wi);
  const BsdfValue scatter = vertex.surface.bsdf->value(vertex.wo, wi);
  if (scatter.f.is_black()) return {};

  // The shadow ray runs between points that are moved off both surfaces.
  const Vec3f from = vertex.origin_towards(light->wi);
  const Vec3f to = light->delta ? light->position : offset_point(light->position, light->normal);
  const Vec3f segment = to - from;
  const float distance = length(segment);
  if (!(distance > 0)) return {};
  if (queries.occluded({from, segment / distance, 0, distance * (1 - 1e-5f)})) return {};

  const float weight = light->delta ? 1.0f : power_heuristic(light->pdf_solid_angle * choice.probability, scatter.pdf);
  return scatter.f * light->weight * (std::fabs(wi.z) * weight / choice.probability);
}

}  // namespace

SampleResult PathIntegrator::trace(Ray ray, Sampler& sampler, RayQueries& queries) const {
  const Scene& scene = *scene_;
  const MethodDescription& method = scene.method();
  const int max_depth = method.max_depth < 0 ? std::numeric_limits<int>::max() : method.max_depth;
  SampleResult result;
  Rgb throughput{1.0f};
  float eta_scale = 1;  // undoes the radiance scaling of refraction in the roulette's view of the throughput
  float bsdf_pdf = 0;   // of the last direction; unused while `delta`
  bool delta = true;    // next-event estimation could not have found the last direction

  for (int depth = 0;; ++depth) {
    Hit hit;
    if (!queries.intersect(ray, hit)) {
      if (scene.environment() && !(depth == 0 && method.hide_emitters)) result.radiance += throughput * *scene.environment();
      return result;
    }
    const Vertex vertex(scene, ray, hit);
    const Scene::Surface& surface = vertex.surface;
    if (depth == 0) {
      result.hit = true;
      result.depth = scene.camera().depth(vertex.point.position);
      result.normal = vertex.wo.z < 0 ? -vertex.point.shading_normal : vertex.point.shading_normal;
      result.albedo = surface.bsdf->albedo(vertex.wo);
    }

    // Emission, weighted against next-event estimation, which could have found it too.
    if (surface.emitter != nullptr && !(depth == 0 && method.hide_emitters)) {
      const Rgb emitted = surface.emitter->radiance(vertex.point, ray.direction);
      if (!emitted.is_black()) {
        float weight = 1;
        if (!delta) {
          const float pdf = surface.shape->pdf(ray.origin, vertex.point, hit.primitive, ray.direction, hit.t);
          weight = power_heuristic(bsdf_pdf, pdf * surface.choice_probability);
        }
        result.radiance += throughput * emitted * weight;
      }
    }
    if (depth + 1 >= max_depth) return result;

    if (surface.bsdf->has_continuous_lobe() && !scene.emitters().empty()) {
      result.radiance += throughput * direct_light(scene, vertex, sampler, queries);
    }

    // The next direction.
    const float u_lobe = sampler.next_1d();
    const std::optional<BsdfSample> scatter = surface.bsdf->sample(vertex.wo, u_lobe, sampler.next_2d());
    if (!scatter) return result;
    throughput *= scatter->weight;
    eta_scale *= scatter->eta * scatter->eta;
    bsdf_pdf = scatter->pdf;
    delta = scatter->delta;

    // Russian roulette by throughput.
    if (depth + 1 >= method.rr_depth) {
      const float survival = std::min(max_component(throughput) * eta_scale, 0.95f);
      if (sampler.next_1d() >= survival) return result;
      throughput *= 1 / survival;
    } else if (throughput.is_black()) {
      return result;
    }
    const Vec3f direction = vertex.frame.to_world(scatter->wi);
    ray = {vertex.origin_towards(direction), direction};
  }
}

void PathIntegrator::radiance(std::span<const CameraSample> samples, std::uint64_t seed, std::span<SampleResult> results,
                              RayQueries& queries) const {
  Sampler sampler(seed);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const CameraSample& sample = samples[i];
    sampler.start_pixel_sample(sample.x, sample.y, sample.index);
    const Vec2f offset = scene_->pixel_filter().sample(sampler.next_2d());
    const Ray ray = scene_->camera().ray(static_cast<float>(sample.x) + 0.5f + offset.x,
                                         static_cast<float>(sample.y) + 0.5f + offset.y);
    results[i] = trace(ray, sampler, queries);
  }
}

}  // namespace fluxfarm
