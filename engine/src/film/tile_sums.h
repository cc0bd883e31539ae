// Sums of one tile over the samples of one pass: what a task returns, a value that adds to a Film.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "film/light_layer.h"
#include "film/pixel_rect.h"
#include "math/rgb.h"
#include "math/vec.h"

namespace fluxfarm {

// Replicates of a pixel; must equal sampling's kReplicates (checked where both meet, in the tile runner).
inline constexpr std::uint32_t kFilmReplicates = 8;

// Features of the first hit, summed: albedo R G B, shading normal x y z, depth along the view axis (m), number of hits.
inline constexpr int kFeatures = 8;

// Estimates of bias are kept in two independent halves: the mean of their product has no noise of its own in it.
inline constexpr std::uint32_t kBiasHalves = 2;

struct TileSums {
  PixelRect rect;
  SampleRange samples;
  std::uint64_t seed = 0;
  // [pixel][k][R G B], k = 0 .. replicates() - 1: the k-th replicate is that of sample samples.begin + k.
  std::vector<float> radiance;
  // [pixel][kFeatures]
  std::vector<float> features;
  // Samples whose radiance was not finite; they are in the sums as zero.
  std::uint64_t non_finite_samples = 0;
  // Radiance once more, by layers and without replicates: [pixel][layers.list()][R G B].
  LightLayers layers = {};
  std::vector<float> layer_sums = {};
  // What a biased method says of its bias, for samples of even and of odd index: [pixel][kBiasHalves][R G B]; empty if it has none.
  bool biased = false;
  std::vector<float> bias_sums = {};

  std::uint32_t replicates() const { return std::min(samples.size(), kFilmReplicates); }
  std::size_t radiance_size() const { return static_cast<std::size_t>(rect.pixels()) * replicates() * 3; }
  std::size_t features_size() const { return static_cast<std::size_t>(rect.pixels()) * kFeatures; }
  std::size_t bias_sums_size() const { return biased ? static_cast<std::size_t>(rect.pixels()) * kBiasHalves * 3 : 0; }
  std::size_t layer_sums_size() const { return static_cast<std::size_t>(rect.pixels()) * layers.size() * 3; }
};

}  // namespace fluxfarm
