#include "worker/tile_runner.h"

#include <algorithm>
#include <array>

#include "integrators/light_history.h"
#include "integrators/pixel_blocks.h"
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
  PixelSums(LightLayers layers, bool biased) : kept_(layers.list()), summed_(kept_), biased_(biased) {
    std::erase(summed_, LightLayer::kIndirect);
  }

  void clear() { sums_ = {}; }

  void add(const SampleResult& result, std::uint32_t slot, std::uint32_t bias_half) {
    add_to(sums_.radiance[slot], result.radiance);
    if (biased_) add_to(sums_.bias[bias_half], result.bias);
    for (const LightLayer layer : summed_) add_to(sums_.layers[index_of(layer)], result.layers[index_of(layer)]);
    if (!result.hit) return;
    const float values[kFeatures] = {result.albedo.r, result.albedo.g, result.albedo.b, result.normal.x,
                                     result.normal.y, result.normal.z, result.depth,    1.0f};
    for (int i = 0; i < kFeatures; ++i) sums_.features[i] += static_cast<double>(values[i]);
  }

  // Writes them into the place of pixel number `index` of the tile.
  void write_to(TileSums& tile, std::size_t index) {
    sums_.layers[index_of(LightLayer::kIndirect)] = left_over();
    float* radiance = tile.radiance.data() + index * tile.replicates() * 3;
    for (std::uint32_t k = 0; k < tile.replicates(); ++k) radiance = write(sums_.radiance[k], radiance);
    write(sums_.features, tile.features.data() + index * kFeatures);
    float* layers = tile.layer_sums.data() + index * kept_.size() * 3;
    for (const LightLayer layer : kept_) layers = write(sums_.layers[index_of(layer)], layers);
    if (!biased_) return;
    float* bias = tile.bias_sums.data() + index * kBiasHalves * 3;
    for (const Sum& half : sums_.bias) bias = write(half, bias);
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
  static float* write(const std::array<double, count>& sums, float* to) {
    for (const double value : sums) *to++ = static_cast<float>(value);
    return to;
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
  bool biased_;                            // as the tile
  struct Sums {
    std::array<Sum, kFilmReplicates> radiance{};
    std::array<double, kFeatures> features{};
    std::array<Sum, kLightLayers> layers{};
    std::array<Sum, kBiasHalves> bias{};
  } sums_;
};

}  // namespace

TileSums render_tile(const Scene& scene, const Integrator& integrator, const TileTask& task, RayQueries& queries,
                     const std::atomic<bool>& cancelled, const std::function<void(std::uint64_t)>& progress) {
  const PixelRect frame{0, 0, scene.film().width, scene.film().height};
  if (!frame.contains(task.rect) || task.rect.empty() || task.samples.begin >= task.samples.end) {
    throw SettingError("tile outside the frame or without samples");
  }
  TileSums sums{
      task.rect, task.samples, task.seed, {}, {}, 0, light_layers(scene.census()), {}, integrator.bias() != Integrator::Bias::kNone,
      {}};
  sums.radiance.resize(sums.radiance_size());
  sums.features.resize(sums.features_size());
  sums.layer_sums.resize(sums.layer_sums_size());
  sums.bias_sums.resize(sums.bias_sums_size());

  const std::size_t per_pixel = task.samples.size();
  std::vector<CameraSample> batch;
  batch.reserve(std::max(kBatch, per_pixel));
  std::vector<SampleResult> results(batch.capacity());
  PixelSums pixel(sums.layers, sums.biased);
  // Sums what came back for the pixel whose samples begin at `first`.
  const auto sum_up = [&](std::size_t first) {
    const CameraSample& at = batch[first];
    pixel.clear();
    for (std::size_t k = 0; k < per_pixel; ++k) {
      SampleResult& result = results[first + k];
      if (!is_finite(result.radiance) || !is_finite(result.bias)) {
        result.radiance = {};
        result.layers = {};
        result.bias = {};
        ++sums.non_finite_samples;
      }
      pixel.add(result, static_cast<std::uint32_t>(k % kFilmReplicates), batch[first + k].index % kBiasHalves);
    }
    pixel.write_to(sums, static_cast<std::size_t>(at.y - task.rect.y) * task.rect.width + (at.x - task.rect.x));
  };
  const auto flush = [&] {
    if (cancelled.load(std::memory_order_relaxed)) throw CancelledError();
    integrator.radiance(batch, task.seed, task.pass, results, queries);
    std::uint64_t pixels = 0;
    for (std::size_t first = 0; first < batch.size(); first += per_pixel) {
      if (!task.rect.contains({batch[first].x, batch[first].y, 1, 1})) continue;
      sum_up(first);
      ++pixels;
    }
    if (progress) progress(pixels * per_pixel);
    batch.clear();
  };
  for_each_block(task.rect, frame, block_size(per_pixel), [&](PixelRect block) {
    if (batch.size() + per_pixel * block.pixels() > kBatch && !batch.empty()) flush();
    for (int y = block.y; y < block.y + block.height; ++y) {
      for (int x = block.x; x < block.x + block.width; ++x) {
        for (std::uint32_t index = task.samples.begin; index < task.samples.end; ++index) batch.push_back({x, y, index});
      }
    }
  });
  if (!batch.empty()) flush();
  return sums;
}

}  // namespace fluxfarm
