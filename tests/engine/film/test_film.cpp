// Merging is addition; the error of a pixel comes from its replicates.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "film/film.h"
#include "film/pass_schedule.h"
#include "sampling/hash.h"
#include "sampling/owen_sobol.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

constexpr PixelRect kCrop{4, 2, 20, 12};
const LightLayers kLayers = LightLayers().insert(LightLayer::kDirect).insert(LightLayer::kIndirect);

// Sums of a tile made of sample values that depend on pixel and sample alone.
TileSums tile_of(PixelRect rect, SampleRange samples, float (*value)(int, int, std::uint32_t)) {
  TileSums sums{rect, samples, 0, {}, {}, 0, kLayers, {}};
  for (int y = rect.y; y < rect.y + rect.height; ++y) {
    for (int x = rect.x; x < rect.x + rect.width; ++x) {
      for (std::uint32_t k = 0; k < sums.replicates(); ++k) {
        float sum = 0;
        for (std::uint32_t i = samples.begin + k; i < samples.end; i += kFilmReplicates) sum += value(x, y, i);
        for (int c = 0; c < 3; ++c) sums.radiance.push_back(sum * static_cast<float>(c + 1));
      }
      // A quarter of radiance is direct, the rest indirect.
      float total = 0;
      for (std::uint32_t i = samples.begin; i < samples.end; ++i) total += value(x, y, i);
      for (const float share : {0.25f, 0.75f}) {
        for (int c = 0; c < 3; ++c) sums.layer_sums.push_back(share * total * static_cast<float>(c + 1));
      }
      for (int f = 0; f < kFeatures; ++f) sums.features.push_back(f == kFeatures - 1 ? static_cast<float>(samples.size()) : 0.5f);
    }
  }
  return sums;
}

float noise(int x, int y, std::uint32_t i) {
  const auto word = static_cast<std::uint32_t>(hash_words(static_cast<std::uint64_t>(x), y, i));
  return -std::log(1 - to_unit_float(word));  // exponential, mean and variance one
}

std::vector<SampleRange> passes(std::uint32_t goal) {
  std::vector<SampleRange> result;
  for (std::uint32_t done = 0; done < goal; done = result.back().end) result.push_back(next_pass(done, goal));
  return result;
}

Film film_of(const std::vector<SampleRange>& schedule, int tile, bool reversed) {
  Film film(40, 30, kCrop, kLayers);
  for (const SampleRange pass : schedule) {
    std::vector<PixelRect> tiles;
    for (int y = kCrop.y; y < kCrop.y + kCrop.height; y += tile) {
      for (int x = kCrop.x; x < kCrop.x + kCrop.width; x += tile) {
        tiles.push_back({x, y, std::min(tile, kCrop.x + kCrop.width - x), std::min(tile, kCrop.y + kCrop.height - y)});
      }
    }
    if (reversed) std::reverse(tiles.begin(), tiles.end());
    for (const PixelRect& rect : tiles) film.merge(tile_of(rect, pass, noise));
  }
  return film;
}

bool same_bits(const Image& a, const Image& b) {
  for (std::size_t c = 0; c < a.channels.size(); ++c) {
    if (a.channels[c].name != b.channels[c].name || a.channels[c].values != b.channels[c].values) return false;
  }
  return a.channels.size() == b.channels.size();
}

TEST(PassSchedule, DoublesToTheCeilingAndEndsAtTheGoal) {
  std::vector<std::uint32_t> sizes;
  for (const SampleRange pass : passes(200)) sizes.push_back(pass.size());
  EXPECT_EQ(sizes, (std::vector<std::uint32_t>{1, 1, 2, 4, 8, 16, 32, 64, 64, 8}));
}

TEST(Film, IsIdenticalForAnyTilingAndTileOrder) {
  const Image reference = film_of(passes(100), 64, false).image(kCrop, {});
  for (const int tile : {1, 3, 8, 16}) {
    EXPECT_TRUE(same_bits(reference, film_of(passes(100), tile, false).image(kCrop, {}))) << tile;
    EXPECT_TRUE(same_bits(reference, film_of(passes(100), tile, true).image(kCrop, {}))) << tile << " reversed";
  }
}

TEST(Film, SurvivesAFileToTheBit) {
  const Film film = film_of(passes(21), 8, false);
  const std::string path = testing::TempDir() + "/film.bin";
  film.save(path);
  Film loaded = Film::load(path);
  EXPECT_TRUE(same_bits(film.image(kCrop, {}), loaded.image(kCrop, {})));
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 1);
  EXPECT_THROW(Film::load(path), ResourceError);
  std::ofstream(path) << "something else";
  EXPECT_THROW(Film::load(path), ResourceError);
}

TEST(Film, RefusesATileTwiceOrOutOfOrderOrOutside) {
  Film film(40, 30, kCrop, kLayers);
  const TileSums tile = tile_of({4, 2, 8, 8}, {0, 1}, noise);
  film.merge(tile);
  EXPECT_THROW(film.merge(tile), Error);
  EXPECT_THROW(film.merge(tile_of({12, 2, 8, 8}, {1, 2}, noise)), Error);
  EXPECT_THROW(film.merge(tile_of({0, 0, 8, 8}, {0, 1}, noise)), Error);
  Film without_layers(40, 30, kCrop);
  EXPECT_THROW(without_layers.merge(tile), Error);
}

TEST(Film, MeansAreSumsOverCountsForEveryNumberOfSamples) {
  for (const std::uint32_t goal : {1u, 2u, 3u, 5u, 8u, 9u, 100u}) {
    const Image image = film_of(passes(goal), 64, false).image({5, 3, 1, 1}, {});
    double expected = 0;
    for (std::uint32_t i = 0; i < goal; ++i) expected += static_cast<double>(noise(5, 3, i)) / goal;
    EXPECT_NEAR(static_cast<double>((*image.find("R"))[0]), expected, 1e-6 * expected) << goal;
    EXPECT_NEAR(static_cast<double>((*image.find("G"))[0]), 2 * expected, 2e-6 * expected) << goal;
    EXPECT_NEAR(static_cast<double>((*image.find("direct.R"))[0]), expected / 4, 1e-6 * expected) << goal;
    EXPECT_NEAR(static_cast<double>((*image.find("indirect.B"))[0]), expected * 9 / 4, 3e-6 * expected) << goal;
    EXPECT_EQ(image.find("caustic.R"), nullptr);
    EXPECT_EQ((*image.find("samples"))[0], static_cast<float>(goal));
  }
}

// Exponential samples have variance 1: the variance of the mean of n is 1/n. Luminance weighs the channels 1, 2, 3.
TEST(Film, NoiseIsTheStandardErrorOfTheMean) {
  const std::uint32_t n = 96;
  Film film(200, 100, {0, 0, 200, 100}, kLayers);
  for (const SampleRange pass : passes(n)) film.merge(tile_of({0, 0, 200, 100}, pass, noise));
  const Image image = film.image(film.crop(), {});
  double mean_square = 0;
  for (const float e : *image.find("error.noise")) mean_square += static_cast<double>(e) * static_cast<double>(e) / 20000;
  const double luminance = 0.2126 + 2 * 0.7152 + 3 * 0.0722;
  const double expected = luminance * luminance / n;
  // The estimate of one pixel has a relative standard deviation of about sqrt(2/7); 20,000 pixels bring it to 0.4 %.
  EXPECT_NEAR(mean_square, expected, 0.02 * expected);
  // Twin: the spread of the replicates themselves, without the division by their number, is eight times as large.
  EXPECT_GT(std::abs(mean_square - 8 * expected), 0.02 * expected);
}

// One sample in a thousand is 300, all others 0.1.
float rare(int x, int y, std::uint32_t i) { return hash_words(static_cast<std::uint64_t>(x), y, i) % 1000 == 0 ? 300.0f : 0.1f; }

// A bright sample raises the pixel that it strikes, and must not hide its error behind that.
TEST(Film, ReportsTheErrorOfRareEvents) {
  constexpr std::uint32_t kSamples = 64;
  const PixelRect frame{0, 0, 200, 100};
  Film film(200, 100, frame, kLayers);
  for (const SampleRange pass : passes(kSamples)) film.merge(tile_of(frame, pass, rare));
  double squares = 0, by_own_mean = 0;
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 200; ++x) {
      const PixelEstimate pixel = film.estimate(x, y);
      for (std::size_t c = 0; c < 3; ++c) {
        const auto mean = static_cast<double>(pixel.mean[c]), noise = static_cast<double>(pixel.standard_error[c]);
        // What pixels show that are not struck, which are nearly all.
        const double likely = 0.1 * static_cast<double>(c + 1);
        squares += (mean - likely) * (mean - likely) / (likely * likely + 1e-2) / (3 * 20000);
        by_own_mean += noise * noise / (mean * mean + 1e-2) / (3 * 20000);
      }
    }
  }
  const double claimed = *film.summary(2).error_noise;
  EXPECT_NEAR(claimed, std::sqrt(squares), 0.05 * std::sqrt(squares));
  EXPECT_LT(std::sqrt(by_own_mean), 0.5 * std::sqrt(squares));  // twin
  EXPECT_EQ(claimed, *film.summary(1).error_noise);
}

TEST(Film, ClaimsNoErrorFromOneReplicate) {
  Film film(40, 30, kCrop, kLayers);
  film.merge(tile_of(kCrop, {0, 1}, noise));
  EXPECT_FALSE(film.summary().error_noise.has_value());
  EXPECT_TRUE(std::isinf((*film.image(kCrop, {}).find("error.noise"))[0]));
  film.merge(tile_of(kCrop, {1, 2}, noise));
  EXPECT_TRUE(film.summary().error_noise.has_value());
}

}  // namespace
}  // namespace fluxfarm
