// The seam between a method and everything around it: prepare once, then answer batches of camera samples.
//
// A batch goes in and a batch of radiances comes out, so that a method may trace its rays one by one, in packets, or sorted,
// without its caller knowing.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "accel/ray_queries.h"
#include "film/light_layer.h"
#include "film/pixel_rect.h"
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
  // What a biased method adds to radiance in the mean, as far as this sample tells: a signed, noisy estimate of the same unit.
  Rgb bias;
  Rgb albedo;       // of the first hit; of an emitter without reflection, black
  Vec3f normal;     // shading normal of the first hit, world, turned towards the camera
  float depth = 0;  // of the first hit along the view axis, m
  bool hit = false;

  void add(Rgb light, LightLayer layer) {
    radiance += light;
    if (layer != LightLayer::kIndirect) layers[static_cast<std::size_t>(layer)] += light;
  }
};

// What all samples of one pass share, made before the first of them: photon maps. Immutable.
class PreparedPass {
 public:
  virtual ~PreparedPass() = default;
  virtual std::uint64_t rays() const = 0;  // that it took
};

// What a method keeps of light.
struct MethodParts {
  bool caustic_map = false, global_map = false, volume_map = false;  // of photons
  bool projection_map = false;                                       // of the emitters' random numbers
  bool irradiance_cache = false;

  bool any() const { return caustic_map || global_map || volume_map || projection_map || irradiance_cache; }
};

class Integrator {
 public:
  virtual ~Integrator() = default;

  virtual const char* name() const = 0;
  // A bias that is more than rounding is told in SampleResult::bias; it falls as samples are added, or it does not.
  enum class Bias { kNone, kFalling, kFixed };
  virtual Bias bias() const { return Bias::kNone; }

  // What it makes of this scene ahead of its samples; after prepare().
  virtual MethodParts parts() const { return {}; }

  // Whether it finds light of delta emitters over delta lobes, which no path that starts at the camera can.
  virtual bool finds_caustics() const { return false; }

  // Builds what the method needs for this scene. Called once, before anything below.
  virtual void prepare(const Scene& scene) = 0;

  // What radiance() of any of these samples needs; null for a method that needs nothing. It depends on the scene, the seed and the
  // samples alone. Throws ResourceError, and CancelledError soon after `cancelled` becomes true.
  virtual std::shared_ptr<const PreparedPass> prepare_pass(std::uint64_t seed, SampleRange samples, int threads,
                                                           const std::atomic<bool>& cancelled) const;

  // Where preparing this pass makes something anew, such as the next level of a cache, about how many times the rays it takes that
  // the last such pass took, or the first one; else 0.
  virtual double growth_at(SampleRange) const { return 0; }

  // Estimates the radiance of each sample, in the order given: whole blocks of pixels one after another, in each the samples of
  // one pixel together, equally many of all (integrators/pixel_blocks.h). `pass` comes from prepare_pass() of this seed and these
  // samples. The results of a block depend on the scene, the seed and the block's samples alone. Safe to call from many threads,
  // each with its own queries.
  virtual void radiance(std::span<const CameraSample> samples, std::uint64_t seed, const PreparedPass* pass,
                        std::span<SampleResult> results, RayQueries& queries) const = 0;
};

// Those that make_integrator() knows. "auto" is none of them: a pilot chooses among these (worker/pilot.h).
const std::vector<std::string>& integrator_names();

// The method of that name, or SettingError that names those there are. "" takes the scene's own.
std::unique_ptr<Integrator> make_integrator(const std::string& name, const Scene& scene);

}  // namespace fluxfarm
