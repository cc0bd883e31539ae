// Light on its way to the paths of a group: shadow rays that pass null boundaries and are dimmed by media.
#pragma once

#include <array>

#include "accel/ray_queries.h"
#include "integrators/pixel_blocks.h"
#include "scene/scene.h"

namespace fluxfarm {

class ShadowRays {
 public:
  ShadowRays(const Scene& scene, RayQueries& queries) : scene_(scene), queries_(queries) {}

  struct Light {
    Rgb radiance;
    LightLayer layer = LightLayer::kDirect;
    const HomogeneousMedium* medium = nullptr;  // in which its ray starts
    SampleResult* result = nullptr;
  };
  // `light` arrives through `ray` if nothing is in between. At most kMaxPaths at a time.
  void add(const Ray& ray, const Light& light) {
    rays_[size_] = ray;
    lights_[size_++] = light;
  }

  // Adds what gets through to the results, and forgets it.
  void gather(bool coherent);

 private:
  void gather_unobstructed(bool coherent);
  bool pass(std::size_t i);

  const Scene& scene_;
  RayQueries& queries_;
  std::size_t size_ = 0;
  std::array<Ray, kMaxPaths> rays_;
  std::array<Light, kMaxPaths> lights_;
  std::array<Hit, kMaxPaths> hits_;
  std::array<bool, kMaxPaths> occluded_;
};

}  // namespace fluxfarm
