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
class PixelSums {
 public:
  explicit PixelSums(LightLayers layers) : kept_(layers.list()), summed_(kept_) { std::erase(summed_, LightLayer::kIndirect); }

  void clear() { sums_ = {}; }

  void add(const SampleResult& result, std::uint32_t slot) {
    add_to(sums_.radiance[slot], result.radiance);
    for (const LightLayer layer : summed_) add_to(sums_.layers[index_of(layer)], result.layers[index_of(layer)]);
    if (!result.hit) return;
    const float values[kFeatures] = {result.albedo.r, result.albedo.g, result.albedo.b, result.normal.x,
                                     result.normal.y, result.normal.z, result.depth,    1.0f};
    for (int i = 0; i < kFeatures; ++i) sums_.features[i] += static_cast<double>(values[i]);
  }

  void append_to(TileSums& tile) {
    sums_.layers[index_of(LightLayer::kIndirect)] = left_over();
    for (std::uint32_t k = 0; k < tile.replicates(); ++k) append(sums_.radiance[k], tile.radiance);
    append(sums_.features, tile.features);
    for (const LightLayer layer : kept_) append(sums_.layers[index_of(layer)], tile.layer_sums);
  }

 private:
  using Sum = std::array<double, 3>;  // R G B

  static std::size_t index_of(LightLayer layer) { return static_cast<std::size_t>(layer); }

  static void add_to(Sum& sum, Rgb radiance) {
    sum[0] += static_cast<double>(radiance.r);
    sum[1] += static_cast<double>(radiance.g);
    sum[2] += static_cast<double>(radiance.b);
  }

  template <std::size_t count>
  static void append(const std::array<double, count>& sums, std::vector<float>& to) {
    for (const double value : sums) to.push_back(static_cast<float>(value));
  }

  // Of beauty, by the layers that are summed. Where that is nothing, the rounding of each sample's float sums may seem to leave
  // less.
  Sum left_over() const {
    Sum rest{};
    for (std::size_t c = 0; c < 3; ++c) {
      for (const Sum& replicate : sums_.radiance) rest[c] += replicate[c];
      for (const LightLayer layer : summed_) rest[c] -= sums_.layers[index_of(layer)][c];
      rest[c] = std::max(rest[c], 0.0);
    }
    return rest;
  }

  std::vector<LightLayer> kept_, summed_;  // the tile's; all but the indirect one
  struct Sums {
    std::array<Sum, kFilmReplicates> radiance{};
    std::array<double, kFeatures> features{};
    std::array<Sum, kLightLayers> layers{};
  } sums_;
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

  std::vector<CameraSample> batch;
  std::vector<SampleResult> results(std::max<std::size_t>(kBatch, task.samples.size()));
  batch.reserve(kBatch);
  PixelSums pixel(sums.layers);
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
      pixel.add(results[i], (batch[i].index - task.samples.begin) % kFilmReplicates);
      if (batch[i].index == last) {
        pixel.append_to(sums);
        pixel.clear();
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
