// The film: running sums of a frame, per pixel and replicate. Sums and counts, never means; merging is addition.
//
// Bits: a pass's sums arrive as float32 and are added in double, pass after pass in sample order. As each pixel belongs to one
// tile of a pass, the order of tiles, their size and who rendered them cannot change a bit.
//
// Error: with replicate means m_r of R independent scrambles, the variance of the pixel mean I is estimated by
// R/(R-1) sum_r (n_r/N)^2 (m_r - I)^2, which is the usual sum (m_r - I)^2 / (R) when the counts n_r are equal.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "film/image.h"
#include "film/light_layer.h"
#include "film/pixel_rect.h"
#include "film/tile_sums.h"
#include "math/median.h"
#include "math/rgb.h"

namespace fluxfarm {

// 97.5 % quantile of Student's t with R - 1 = 7 degrees of freedom: pixel mean +- kNoiseInterval95 * error.noise is the 95 %
// interval.
inline constexpr float kNoiseInterval95 = 2.364624f;

struct FilmSummary {
  std::uint32_t min_samples = 0, max_samples = 0;
  double mean_samples = 0;  // per pixel
  // sqrt of the estimated relMSE, as the decisions of error goals have it (film/error_shares.h); absent below two replicates.
  std::optional<double> error_noise;
  // The same of the method's bias; 0 for a method without one, absent below two samples of one that has.
  std::optional<double> error_bias;
  double mean[3] = {0, 0, 0};
  std::uint64_t non_finite_samples = 0;
};

// What the EXR header says beside the pixels.
struct ImageInfo {
  std::string job, scene_digest, integrator, engine_build;
  std::uint64_t seed = 0;
};

// Lanes: R G B and nothing.
struct PixelEstimate {
  Lanes mean = {};
  Lanes standard_error = {};  // of the mean
  Lanes median = {};          // of the replicates' means
};

class Film {
 public:
  // Holds the pixels of `crop` of a width x height frame, with those light layers.
  // `biased`: made by a method that has a bias and says so.
  Film(int width, int height, PixelRect crop, LightLayers layers = {}, bool biased = false);

  // Reads what save() wrote. Throws ResourceError when the file cannot be read or is not a film.
  static Film load(const std::filesystem::path& path);
  void save(const std::filesystem::path& path) const;

  // Adds one tile's sums. The tile must lie in the crop, have the film's layers and bias and carry on where its pixels' samples
  // end: Error otherwise. Threads may merge disjoint tiles at the same time.
  void merge(const TileSums& tile);

  FilmSummary summary(int threads = 1) const;
  // The pixel at (x, y) of the frame, R G B. No standard error below two replicates.
  PixelEstimate estimate(int x, int y) const;
  std::uint32_t samples(int x, int y) const { return pixel(x, y).samples; }
  // What the pixel at (x, y) of the frame adds to the relMSE by bias, the mean over channels of b^2 / (I^2 + 1e-2): an unbiased
  // estimate, which may be negative. From two samples on, of a biased film.
  double bias_share(int x, int y) const;
  // Layers R G B, the light layers, albedo.*, N.*, Z, error.noise, samples and, if biased, error.bias of `rect` (inside the crop),
  // with header attributes. error.noise is the standard error of the pixel's Rec.709 luminance; infinite below two replicates: no
  // claim. error.bias is the luminance of the estimated bias without its sign; it is noisy. Z is the mean depth of the samples that
  // hit something, 1e10 where none did.
  Image image(PixelRect rect, const ImageInfo& info) const;

  int width() const { return width_; }
  int height() const { return height_; }
  PixelRect crop() const { return crop_; }
  LightLayers layers() const { return layers_; }
  bool biased() const { return biased_; }
  // Mean of one layer in the pixel at (x, y) of the frame; black if the film does not have it.
  Rgb layer_mean(int x, int y, LightLayer layer) const;
  // Sum of one replicate of the pixel at (x, y) of the frame; for tests and tools.
  Rgb replicate_mean(int x, int y, std::uint32_t replicate) const;

 private:
  struct Pixel {
    double radiance[kFilmReplicates][3] = {};
    double features[kFeatures] = {};
    std::uint32_t samples = 0;
    std::uint32_t padding = 0;  // written to the film file: keep it zero
  };
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y - crop_.y) * crop_.width + (x - crop_.x); }
  const Pixel& pixel(int x, int y) const { return pixels_[index(x, y)]; }

  int width_, height_;
  PixelRect crop_;
  LightLayers layers_;
  bool biased_;
  std::uint64_t non_finite_samples_ = 0;
  std::vector<Pixel> pixels_;
  std::vector<double> layer_sums_;  // [pixel][layers_.list()][R G B]
  std::vector<double> bias_sums_;   // [pixel][kBiasHalves][R G B]; empty unless biased_
};

}  // namespace fluxfarm
