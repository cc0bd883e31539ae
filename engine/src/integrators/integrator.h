// The seam between a method and everything around it: prepare once, then answer batches of camera samples.
//
// A batch goes in and a batch of radiances comes out, so that a method may trace its rays one by one, in packets, or sorted,
// without its caller knowing.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "accel/ray_queries.h"
#include "film/light_layer.h"
#include "math/rgb.h"
#include "math/vec.h"
#include "scene/scene.h"

namespace fluxfarm {

// Sample `index` of pixel (x, y) of the full frame.
struct CameraSample {
  int x = 0, y = 0;
  std::uint32_t index = 0;
};

// What a camera sample brings back.
struct SampleResult {
  Rgb radiance;  // W m^-2 sr^-1
  // Of it, by LightLayer; the indirect layer is left black: it is what the others leave over, and most light of a path is indirect.
  std::array<Rgb, kLightLayers> layers;
  Rgb albedo;       // of the first hit; of an emitter without reflection, black
  Vec3f normal;     // shading normal of the first hit, world, turned towards the camera
  float depth = 0;  // of the first hit along the view axis, m
  bool hit = false;

  void add(Rgb light, LightLayer layer) {
    radiance += light;
    if (layer != LightLayer::kIndirect) layers[static_cast<std::size_t>(layer)] += light;
  }
};

class Integrator {
 public:
  virtual ~Integrator() = default;

  // Builds what the method needs for this scene. Called once, before any radiance().
  virtual void prepare(const Scene& scene) = 0;

  // Estimates the radiance of each sample, in the order given: whole blocks of pixels one after another, in each the samples of
  // one pixel together, equally many of all (integrators/pixel_blocks.h). The results of a block depend on the scene, the seed and
  // the block's samples alone. Safe to call from many threads, each with its own queries.
  virtual void radiance(std::span<const CameraSample> samples, std::uint64_t seed, std::span<SampleResult> results,
                        RayQueries& queries) const = 0;
};

// The method of that name ("path"), or SettingError that names those there are. "" takes the scene's own.
std::unique_ptr<Integrator> make_integrator(const std::string& name, const Scene& scene);

}  // namespace fluxfarm
