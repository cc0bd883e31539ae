#include "film/film.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <numeric>

#include "film/error_shares.h"
#include "film/tile_grid.h"
#include "support/error.h"
#include "support/parallel.h"

namespace fluxfarm {
namespace {

constexpr char kMagic[8] = {'F', 'L', 'U', 'X', 'F', 'L', 'M', '2'};
// In a film file, beside the bits of the light layers.
constexpr std::uint32_t kBiasedBit = 1u << 31;
constexpr float kNoDepth = 1e10f;

// Samples 0 .. n-1 fall round-robin into the replicates.
std::uint32_t replicate_samples(std::uint32_t samples, std::uint32_t replicate) {
  return (samples + kFilmReplicates - 1 - replicate) / kFilmReplicates;
}

// Of relMSE, over the pixels of the crop together.
double noise_share(const Film& film, int threads) {
  constexpr int kTile = 64;
  const std::vector<PixelRect> tiles = make_tiles(film.crop(), kTile);
  std::vector<double> sums(tiles.size());
  parallel_for(tiles.size(), threads, [&](std::size_t i, int) {
    const PixelRect& tile = tiles[i];
    const ErrorShares shares(film, tile);
    for (int y = tile.y; y < tile.y + tile.height; ++y) {
      for (int x = tile.x; x < tile.x + tile.width; ++x) sums[i] += shares.at(x, y);
    }
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

struct PixelMean {
  double mean[3];
  double variance[3];  // of the mean
  double luminance_variance;
  bool has_variance;
};

constexpr double kLuminance[3] = {0.2126, 0.7152, 0.0722};

PixelMean pixel_mean(const double radiance[kFilmReplicates][3], std::uint32_t samples) {
  PixelMean result{};
  if (samples == 0) return result;
  const double total = samples;
  for (int c = 0; c < 3; ++c) {
    for (std::uint32_t r = 0; r < kFilmReplicates; ++r) result.mean[c] += radiance[r][c];
    result.mean[c] /= total;
  }
  const std::uint32_t replicates = std::min(samples, kFilmReplicates);
  result.has_variance = replicates >= 2;
  if (!result.has_variance) return result;
  for (std::uint32_t r = 0; r < replicates; ++r) {
    const double count = replicate_samples(samples, r);
    double luminance = 0;
    for (int c = 0; c < 3; ++c) {
      const double deviation = (radiance[r][c] - count * result.mean[c]) / total;  // (n_r / N) (m_r - I)
      result.variance[c] += deviation * deviation;
      luminance += kLuminance[c] * deviation;
    }
    result.luminance_variance += luminance * luminance;
  }
  const double factor = replicates / (replicates - 1.0);
  for (double& variance : result.variance) variance *= factor;
  result.luminance_variance *= factor;
  return result;
}

// Median of the replicates' means, by channels.
Lanes replicate_median(const double radiance[kFilmReplicates][3], std::uint32_t samples) {
  const std::uint32_t replicates = std::min(samples, kFilmReplicates);
  if (replicates == 0) return {};
  std::array<Lanes, kFilmReplicates> means = {};
  for (std::uint32_t r = 0; r < replicates; ++r) {
    const double count = replicate_samples(samples, r);
    for (std::size_t c = 0; c < 3; ++c) means[r][c] = static_cast<float>(radiance[r][c] / count);
  }
  return median(means, replicates);
}

template <typename T>
void write_value(std::ofstream& out, const T& value) {
  out.write(reinterpret_cast<const char*>(&value), sizeof value);
}

template <typename T>
void read_value(std::ifstream& in, T& value) {
  in.read(reinterpret_cast<char*>(&value), sizeof value);
}

template <typename T>
void write_values(std::ofstream& out, const std::vector<T>& values) {
  out.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
}

template <typename T>
void read_values(std::ifstream& in, std::vector<T>& values) {
  in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
}

}  // namespace

Film::Film(int width, int height, PixelRect crop, LightLayers layers, bool biased)
    : width_(width),
      height_(height),
      crop_(crop),
      layers_(layers),
      biased_(biased),
      pixels_(static_cast<std::size_t>(crop.pixels())),
      layer_sums_(pixels_.size() * layers.size() * 3),
      bias_sums_(biased ? pixels_.size() * kBiasHalves * 3 : 0) {}

void Film::merge(const TileSums& tile) {
  if (!crop_.contains(tile.rect) || tile.radiance.size() != tile.radiance_size() || tile.features.size() != tile.features_size()) {
    throw Error("tile does not fit the film: rect " + std::to_string(tile.rect.x) + "," + std::to_string(tile.rect.y) + " " +
                std::to_string(tile.rect.width) + "x" + std::to_string(tile.rect.height));
  }
  if (tile.layers != layers_ || tile.layer_sums.size() != tile.layer_sums_size()) {
    throw Error("tile does not fit the film: light layers " + std::to_string(tile.layers.bits()) + ", expected " +
                std::to_string(layers_.bits()));
  }
  if (tile.biased != biased_ || tile.bias_sums.size() != tile.bias_sums_size()) {
    throw Error("tile does not fit the film: one of them is of a biased method");
  }
  const std::uint32_t replicates = tile.replicates();
  const std::size_t layer_values = layers_.size() * 3, bias_values = biased_ ? kBiasHalves * 3 : 0;
  const float* radiance = tile.radiance.data();
  const float* features = tile.features.data();
  const float* layers = tile.layer_sums.data();
  const float* bias = tile.bias_sums.data();
  for (int y = tile.rect.y; y < tile.rect.y + tile.rect.height; ++y) {
    for (int x = tile.rect.x; x < tile.rect.x + tile.rect.width; ++x) {
      Pixel& p = pixels_[index(x, y)];
      if (p.samples != tile.samples.begin) {
        throw Error("tile at " + std::to_string(tile.rect.x) + "," + std::to_string(tile.rect.y) + " begins at sample " +
                    std::to_string(tile.samples.begin) + ", but the film has " + std::to_string(p.samples));
      }
      for (std::uint32_t k = 0; k < replicates; ++k) {
        double* sum = p.radiance[(tile.samples.begin + k) % kFilmReplicates];
        for (int c = 0; c < 3; ++c) sum[c] += static_cast<double>(*radiance++);
      }
      for (double& feature : p.features) feature += static_cast<double>(*features++);
      double* layer_sum = layer_sums_.data() + index(x, y) * layer_values;
      for (std::size_t i = 0; i < layer_values; ++i) layer_sum[i] += static_cast<double>(*layers++);
      double* bias_sum = bias_sums_.data() + index(x, y) * bias_values;
      for (std::size_t i = 0; i < bias_values; ++i) bias_sum[i] += static_cast<double>(*bias++);
      p.samples = tile.samples.end;
    }
  }
  std::atomic_ref(non_finite_samples_) += tile.non_finite_samples;
}

FilmSummary Film::summary(int threads) const {
  FilmSummary result;
  result.non_finite_samples = non_finite_samples_;
  if (pixels_.empty()) return result;
  result.min_samples = std::numeric_limits<std::uint32_t>::max();
  double bias = 0;
  bool has_variance = true;
  for (const Pixel& p : pixels_) {
    const PixelMean m = pixel_mean(p.radiance, p.samples);
    result.min_samples = std::min(result.min_samples, p.samples);
    result.max_samples = std::max(result.max_samples, p.samples);
    result.mean_samples += p.samples;
    has_variance = has_variance && m.has_variance;
    for (int c = 0; c < 3; ++c) result.mean[c] += m.mean[c];
  }
  const double count = static_cast<double>(pixels_.size());
  for (double& mean : result.mean) mean /= count;
  result.mean_samples /= count;
  if (has_variance) result.error_noise = std::sqrt(noise_share(*this, threads) / count);
  if (!biased_) {
    result.error_bias = 0;
  } else if (result.min_samples >= kBiasHalves) {
    for (int y = crop_.y; y < crop_.y + crop_.height; ++y) {
      for (int x = crop_.x; x < crop_.x + crop_.width; ++x) bias += bias_share(x, y);
    }
    result.error_bias = std::sqrt(std::max(bias / count, 0.0));
  }
  return result;
}

double Film::bias_share(int x, int y) const {
  const Pixel& p = pixel(x, y);
  const PixelMean m = pixel_mean(p.radiance, p.samples);
  const double* sums = bias_sums_.data() + index(x, y) * kBiasHalves * 3;
  const std::uint32_t odd = p.samples / kBiasHalves, even = p.samples - odd;
  double share = 0;
  for (int c = 0; c < 3; ++c) share += sums[c] / even * (sums[3 + c] / odd) / (m.mean[c] * m.mean[c] + 1e-2);
  return share / 3;
}

PixelEstimate Film::estimate(int x, int y) const {
  const Pixel& p = pixel(x, y);
  const PixelMean m = pixel_mean(p.radiance, p.samples);
  PixelEstimate estimate;
  for (std::size_t c = 0; c < 3; ++c) {
    estimate.mean[c] = static_cast<float>(m.mean[c]);
    estimate.standard_error[c] = static_cast<float>(std::sqrt(m.variance[c]));
  }
  estimate.median = replicate_median(p.radiance, p.samples);
  return estimate;
}

Image Film::image(PixelRect rect, const ImageInfo& info) const {
  static constexpr std::array kNames = {"R",   "G",   "B",   "albedo.R", "albedo.G",    "albedo.B",
                                        "N.X", "N.Y", "N.Z", "Z",        "error.noise", "samples"};
  if (!crop_.contains(rect)) throw Error("the part of the film that was asked for lies outside its crop");
  Image image{width_, height_, rect, {}, {}};
  for (const char* name : kNames) image.channels.push_back({name, {}});
  for (const LightLayer layer : layers_.list()) {
    const std::string name = kLightLayerNames[static_cast<std::size_t>(layer)];
    for (const char* channel : {".R", ".G", ".B"}) image.channels.push_back({name + channel, {}});
  }
  if (biased_) image.channels.push_back({"error.bias", {}});
  for (ImageChannel& channel : image.channels) channel.values.reserve(static_cast<std::size_t>(rect.pixels()));
  const std::size_t layer_values = layers_.size() * 3;
  std::uint32_t max_samples = 0;
  for (int y = rect.y; y < rect.y + rect.height; ++y) {
    for (int x = rect.x; x < rect.x + rect.width; ++x) {
      const Pixel& p = pixel(x, y);
      const PixelMean m = pixel_mean(p.radiance, p.samples);
      const double scale = p.samples > 0 ? 1.0 / p.samples : 0.0;
      const double hits = p.features[7];
      std::size_t channel = 0;
      const auto put = [&](double value) { image.channels[channel++].values.push_back(static_cast<float>(value)); };
      for (const double value : m.mean) put(value);
      for (int f = 0; f < 6; ++f) put(p.features[f] * scale);
      put(hits > 0 ? p.features[6] / hits : kNoDepth);
      put(m.has_variance ? std::sqrt(m.luminance_variance) : std::numeric_limits<double>::infinity());
      put(p.samples);
      const double* layer_sum = layer_sums_.data() + index(x, y) * layer_values;
      for (std::size_t i = 0; i < layer_values; ++i) put(layer_sum[i] * scale);
      if (biased_) {
        const double* bias = bias_sums_.data() + index(x, y) * kBiasHalves * 3;
        double luminance = 0;
        for (std::size_t c = 0; c < 3; ++c) luminance += kLuminance[c] * (bias[c] + bias[3 + c]);
        put(std::fabs(luminance) * scale);
      }
      max_samples = std::max(max_samples, p.samples);
    }
  }
  image.attributes = {{"fluxfarm.job", info.job},
                      {"fluxfarm.sceneDigest", info.scene_digest},
                      {"fluxfarm.integrator", info.integrator},
                      {"fluxfarm.samples", static_cast<int>(max_samples)},
                      {"fluxfarm.seed", std::to_string(info.seed)},
                      {"fluxfarm.engine", info.engine_build},
                      {"fluxfarm.noiseInterval95", kNoiseInterval95}};
  return image;
}

Rgb Film::layer_mean(int x, int y, LightLayer layer) const {
  const std::vector<LightLayer> layers = layers_.list();
  const auto place = static_cast<std::size_t>(std::ranges::find(layers, layer) - layers.begin());
  const std::uint32_t count = samples(x, y);
  if (place == layers.size() || count == 0) return {};
  const double* sum = layer_sums_.data() + (index(x, y) * layers.size() + place) * 3;
  return {static_cast<float>(sum[0] / count), static_cast<float>(sum[1] / count), static_cast<float>(sum[2] / count)};
}

Rgb Film::replicate_mean(int x, int y, std::uint32_t replicate) const {
  const Pixel& p = pixel(x, y);
  const double count = replicate_samples(p.samples, replicate);
  if (count == 0) return {};
  const double* sum = p.radiance[replicate];
  return {static_cast<float>(sum[0] / count), static_cast<float>(sum[1] / count), static_cast<float>(sum[2] / count)};
}

void Film::save(const std::filesystem::path& path) const {
  static_assert(std::is_trivially_copyable_v<Pixel> && sizeof(Pixel) == 8 * (3 * kFilmReplicates + kFeatures + 1));
  std::ofstream out(path, std::ios::binary);
  out.write(kMagic, sizeof kMagic);
  for (const int value : {width_, height_, crop_.x, crop_.y, crop_.width, crop_.height}) write_value(out, value);
  write_value(out, layers_.bits() | (biased_ ? kBiasedBit : 0));
  write_value(out, non_finite_samples_);
  write_values(out, pixels_);
  write_values(out, layer_sums_);
  write_values(out, bias_sums_);
  out.flush();
  if (!out) throw ResourceError(path.string() + ": cannot write the film, is the disk full?");
}

Film Film::load(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  char magic[sizeof kMagic] = {};
  in.read(magic, sizeof magic);
  if (!in || std::memcmp(magic, kMagic, sizeof kMagic) != 0) throw ResourceError(path.string() + ": not a film file");
  int width = 0, height = 0;
  PixelRect crop;
  for (int* value : {&width, &height, &crop.x, &crop.y, &crop.width, &crop.height}) read_value(in, *value);
  std::uint32_t layers = 0;
  read_value(in, layers);
  const bool biased = (layers & kBiasedBit) != 0;
  layers &= ~kBiasedBit;
  if (!in || crop.empty() || LightLayers(layers).bits() != layers || !PixelRect{0, 0, width, height}.contains(crop)) {
    throw ResourceError(path.string() + ": damaged film header");
  }
  Film film(width, height, crop, LightLayers(layers), biased);
  read_value(in, film.non_finite_samples_);
  read_values(in, film.pixels_);
  read_values(in, film.layer_sums_);
  read_values(in, film.bias_sums_);
  if (!in) throw ResourceError(path.string() + ": film file is cut short");
  return film;
}

}  // namespace fluxfarm
