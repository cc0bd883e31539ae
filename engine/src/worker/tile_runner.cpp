#include "worker/tile_runner.h"

#include <algorithm>
#include <array>

#include "integrators/light_history.h"
#include "sampling/sampler.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

static_assert(kReplicates == kFilmReplicates, "sampler and film must agree on the number of replicates");

// Large enough for methods that sort or pack rays, small enough that cancelling is noticed within milliseconds.
constexpr std::size_t kBatch = 512;

// Sums of one pixel over the pass, in sample order.
struct PixelSums {
  std::array<std::array<double, 3>, kFilmReplicates> radiance{};
  std::array<double, kFeatures> features{};
  std::array<std::array<double, 3>, kLightLayers> layers{};

  void add(const SampleResult& result, std::uint32_t slot, const std::vector<LightLayer>& kept) {
    add_to(radiance[slot], result.radiance);
    for (const LightLayer layer : kept) add_to(layers[index_of(layer)], result.layers[index_of(layer)]);
    if (!result.hit) return;
    const float values[kFeatures] = {result.albedo.r, result.albedo.g, result.albedo.b, result.normal.x,
                                     result.normal.y, result.normal.z, result.depth,    1.0f};
    for (int i = 0; i < kFeatures; ++i) features[i] += static_cast<double>(values[i]);
  }

  void append_to(TileSums& sums, const std::vector<LightLayer>& kept) const {
    for (std::uint32_t k = 0; k < sums.replicates(); ++k) {
      for (const double value : radiance[k]) sums.radiance.push_back(static_cast<float>(value));
    }
    for (const double value : features) sums.features.push_back(static_cast<float>(value));
    for (const LightLayer layer : kept) {
      for (const double value : layers[index_of(layer)]) sums.layer_sums.push_back(static_cast<float>(value));
    }
  }

 private:
  static std::size_t index_of(LightLayer layer) { return static_cast<std::size_t>(layer); }
  static void add_to(std::array<double, 3>& sum, Rgb radiance) {
    sum[0] += static_cast<double>(radiance.r);
    sum[1] += static_cast<double>(radiance.g);
    sum[2] += static_cast<double>(radiance.b);
  }
};

}  // namespace

TileSums render_tile(const Scene& scene, const Integrator& integrator, const TileTask& task, RayQueries& queries,
                     const std::atomic<bool>& cancelled, const std::function<void(std::uint64_t)>& progress) {
  if (!PixelRect{0, 0, scene.film().width, scene.film().height}.contains(task.rect) || task.rect.empty() ||
      task.samples.begin >= task.samples.end) {
    throw SettingError("tile outside the frame or without samples");
  }
  TileSums sums{task.rect, task.samples, task.seed, {}, {}, 0, light_layers(scene.census()), {}};
  sums.radiance.reserve(sums.radiance_size());
  sums.features.reserve(sums.features_size());
  sums.layer_sums.reserve(sums.layer_sums_size());
  const std::vector<LightLayer> kept = sums.layers.list();

  std::vector<CameraSample> batch;
  std::vector<SampleResult> results(std::max<std::size_t>(kBatch, task.samples.size()));
  batch.reserve(kBatch);
  PixelSums pixel;
  const std::uint32_t last = task.samples.end - 1;
  const auto flush = [&] {
    if (cancelled.load(std::memory_order_relaxed)) throw CancelledError();
    integrator.radiance(batch, task.seed, results, queries);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (!is_finite(results[i].radiance)) {
        results[i].radiance = {};
        results[i].layers = {};
        ++sums.non_finite_samples;
      }
      pixel.add(results[i], (batch[i].index - task.samples.begin) % kFilmReplicates, kept);
      if (batch[i].index == last) {
        pixel.append_to(sums, kept);
        pixel = {};
      }
    }
    if (progress) progress(batch.size());
    batch.clear();
  };
  for (int y = task.rect.y; y < task.rect.y + task.rect.height; ++y) {
    for (int x = task.rect.x; x < task.rect.x + task.rect.width; ++x) {
      // Whole pixels only: how a method groups a pixel's samples must not depend on the tile.
      if (batch.size() + task.samples.size() > kBatch && !batch.empty()) flush();
      for (std::uint32_t index = task.samples.begin; index < task.samples.end; ++index) batch.push_back({x, y, index});
    }
  }
  if (!batch.empty()) flush();
  return sums;
}

}  // namespace fluxfarm
