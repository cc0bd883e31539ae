// Every pixel's share in the error: against the guess of the true value that the neighbours help with.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <utility>

#include "film/error_shares.h"

namespace fluxfarm {
namespace {

constexpr PixelRect kCrop{8, 4, 12, 10};
constexpr PixelRect kMiddle{13, 8, 1, 1};

// Mean of replicate r in all channels; one sample each.
using Replicates = std::function<float(int x, int y, std::uint32_t r)>;

Film film_of(const Replicates& replicate) {
  TileSums sums{kCrop, {0, kFilmReplicates}, 0, {}, {}, 0};
  for (int y = kCrop.y; y < kCrop.y + kCrop.height; ++y) {
    for (int x = kCrop.x; x < kCrop.x + kCrop.width; ++x) {
      for (std::uint32_t r = 0; r < kFilmReplicates; ++r) sums.radiance.insert(sums.radiance.end(), 3, replicate(x, y, r));
      sums.features.insert(sums.features.end(), kFeatures, 0.0f);
    }
  }
  Film film(40, 20, kCrop);
  film.merge(sums);
  return film;
}

bool in_the_middle(int x, int y) { return x == kMiddle.x && y == kMiddle.y; }

// Half of the replicates lie above `mean` by `spread`, half below.
float even(float mean, float spread, std::uint32_t r) { return mean + (r % 2 == 0 ? spread : -spread); }

double variance(double spread) { return spread * spread / (kFilmReplicates - 1); }

double share_in_the_middle(const Film& film) { return ErrorShares(film, kMiddle).at(kMiddle.x, kMiddle.y); }

TEST(ErrorShares, AnEvenPictureHasItsVarianceOverItsSquare) {
  const Film film = film_of([](int, int, std::uint32_t r) { return even(2, 0.5f, r); });
  const ErrorShares shares(film, kCrop);
  for (const auto& [x, y] : {std::pair{8, 4}, {19, 13}, {13, 8}}) EXPECT_NEAR(shares.at(x, y), variance(0.5) / 4.01, 1e-8);
}

TEST(ErrorShares, ABrightSampleDoesNotHideItsError) {
  const Film film = film_of([](int x, int y, std::uint32_t r) { return in_the_middle(x, y) && r == 3 ? 801.0f : 1.0f; });
  const double share = share_in_the_middle(film);
  EXPECT_NEAR(share, 100 * 100 / 1.01, 1) << "mean 101, standard error 100; the neighbours say 1";
  // Twin: the pixel's own mean of 101 for the true value would make it a ten-thousandth of that.
  const PixelEstimate pixel = film.estimate(kMiddle.x, kMiddle.y);
  EXPECT_LT(std::pow(pixel.standard_error[0] / pixel.mean[0], 2), 1e-3 * share);
}

TEST(ErrorShares, APixelThatIsClearlyDarkerKeepsItsOwnValue) {
  const Film film = film_of([](int x, int y, std::uint32_t r) { return even(in_the_middle(x, y) ? 0.5f : 5.0f, 0.1f, r); });
  EXPECT_NEAR(share_in_the_middle(film), variance(0.1) / 0.26, 1e-6);
}

TEST(ErrorShares, APixelThatIsDarkerByChanceTakesTheNeighboursValue) {
  const Film film = film_of([](int x, int y, std::uint32_t r) { return even(in_the_middle(x, y) ? 0.9f : 1.0f, 0.5f, r); });
  EXPECT_NEAR(share_in_the_middle(film), variance(0.5) / 1.01, 1e-7);
}

TEST(ErrorShares, TheEdgeOfALampIsMeasuredByTheLamp) {
  // The middle pixel shows half of a lamp of 20 that covers its right neighbours.
  const Film film = film_of([](int x, int y, std::uint32_t r) {
    if (x > kMiddle.x) return even(20, 0.1f, r);
    return in_the_middle(x, y) ? even(10, 2, r) : even(1, 0.1f, r);
  });
  const double value = 10 - 0.8 * std::sqrt(variance(2));
  EXPECT_NEAR(share_in_the_middle(film), variance(2) / (value * value + 1e-2), 1e-6);
}

TEST(ErrorShares, DoNotDependOnTheTileTheyAreMeasuredIn) {
  const Film film = film_of([](int x, int y, std::uint32_t r) { return static_cast<float>((7 * x + 13 * y + 5 * r * x) % 11); });
  const ErrorShares whole(film, kCrop);
  for (const PixelRect tile : {PixelRect{8, 4, 5, 5}, PixelRect{13, 4, 7, 5}, PixelRect{8, 9, 5, 5}, PixelRect{13, 9, 7, 5}}) {
    const ErrorShares shares(film, tile);
    for (int y = tile.y; y < tile.y + tile.height; ++y) {
      for (int x = tile.x; x < tile.x + tile.width; ++x) EXPECT_EQ(shares.at(x, y), whole.at(x, y)) << x << ", " << y;
    }
  }
}

}  // namespace
}  // namespace fluxfarm
