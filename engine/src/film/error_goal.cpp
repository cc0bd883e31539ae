#include "film/error_goal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "film/error_bound.h"
#include "film/tile_grid.h"
#include "film/unseen_error.h"

namespace fluxfarm {
namespace {

// A choice: with one, tiles would end at the goal and leave no room for the confidence; smaller ones spend samples where they
// lower the picture's error little.
constexpr double kOpenAbove = 0.5;
// Side of the cells over which the carriers of the error are pooled, in pixels.
constexpr int kCell = 4;

// Below so many pixels that carry the error of a neighbourhood, a tile's own error may be that of a lucky one (a choice).
constexpr double kFewCarriers = 64;
// So many standard errors make a pixel differ clearly (a choice: with two, chance biases the error of an even picture).
constexpr double kDistinct = 3;

// So many standard errors are taken off a pixel at the edge of a bright one: few samples may have hit what is bright. Measured on
// veach-mis, 128x72 at 10 %: with 0 only 3 of 10 pictures keep the goal, with 0.7 14 of 16, with 0.8 all of 24, of which 16 have
// more than half of the error that was asked for, with 1 only 4 of 10.
constexpr double kDoubt = 0.8;

// Beyond so many samples a pixel no tile stays open because the audit doubts it (a choice): an event that rare is not worth a wait
// without an end.
constexpr std::uint32_t kMostForDoubt = 4096;

struct TileError {
  double pixels = 0;
  std::uint32_t samples = 0;  // of each pixel
  double own = 0;             // mean share of relMSE
  double squares = 0;         // sum over the cells of (sum of shares)^2 / pixels
  double pooled = 0;          // the share that the neighbours make likely

  double deciding() const { return std::max(own, pooled); }
  void take_round(std::uint32_t end) {
    const double left = static_cast<double>(samples) / end;
    own *= left;
    pooled *= left;
    samples = end;
  }
};

// Every pixel's estimated share in relMSE: the mean over channels of Var(I) / (R^2 + 1e-2). I itself will not do for R: a single
// bright sample raises it, which would hide the error that it makes, and where it is low by chance it exaggerates.
class ErrorShares {
 public:
  explicit ErrorShares(const Film& film) : crop_(film.crop()) {
    estimates_.reserve(static_cast<std::size_t>(crop_.pixels()));
    for (int y = crop_.y; y < crop_.y + crop_.height; ++y) {
      for (int x = crop_.x; x < crop_.x + crop_.width; ++x) estimates_.push_back(film.estimate(x, y));
    }
  }

  // (x, y) in the frame.
  double at(int x, int y) const {
    const PixelEstimate& pixel = estimate(x, y);
    double share = 0;
    for (int c = 0; c < 3; ++c) {
      const double value = likely_value(x, y, c);
      share += pixel.variance[c] / (value * value + 1e-2) / 3;
    }
    return share;
  }

 private:
  const PixelEstimate& estimate(int x, int y) const {
    return estimates_[static_cast<std::size_t>(y - crop_.y) * crop_.width + (x - crop_.x)];
  }

  // R of one channel: the median over 3 x 3 pixels, unless the pixel is clearly darker, or brighter with a clearly bright one among
  // them, such as a lamp of which it shows the edge.
  double likely_value(int x, int y, int channel) const {
    const PixelEstimate& pixel = estimate(x, y);
    const PixelRect near = clipped(PixelRect{x - 1, y - 1, 3, 3});
    std::array<double, 9> means{};
    std::size_t count = 0;
    for (int v = near.y; v < near.y + near.height; ++v) {
      for (int u = near.x; u < near.x + near.width; ++u) means[count++] = estimate(u, v).mean[channel];
    }
    std::nth_element(means.begin(), means.begin() + count / 2, means.begin() + count);
    const double around = means[count / 2], mean = pixel.mean[channel];
    if (mean <= around) return differ(pixel.variance[channel], around, mean) ? mean : around;
    double value = around;
    for (int v = near.y; v < near.y + near.height; ++v) {
      for (int u = near.x; u < near.x + near.width; ++u) {
        // One bright sample does not move the median of the replicates.
        const PixelEstimate& other = estimate(u, v);
        if (differ(other.variance[channel], other.median[channel], around)) {
          value = std::max(value, std::min(mean - kDoubt * std::sqrt(pixel.variance[channel]), other.median[channel]));
        }
      }
    }
    return value;
  }

  static bool differ(double variance, double larger, double smaller) {
    return larger > smaller && (larger - smaller) * (larger - smaller) > kDistinct * kDistinct * variance;
  }

  PixelRect clipped(PixelRect rect) const {
    const int left = std::max(rect.x, crop_.x), top = std::max(rect.y, crop_.y);
    const int right = std::min(rect.x + rect.width, crop_.x + crop_.width);
    const int bottom = std::min(rect.y + rect.height, crop_.y + crop_.height);
    return {left, top, right - left, bottom - top};
  }

  PixelRect crop_;
  std::vector<PixelEstimate> estimates_;
};

TileError measure(const Film& film, const ErrorShares& shares, PixelRect rect, ErrorBound& bound) {
  TileError tile;
  tile.pixels = rect.pixels();
  tile.samples = film.samples(rect.x, rect.y);
  for (const PixelRect& cell : make_tiles(rect, kCell)) {
    double share = 0;
    for (int y = cell.y; y < cell.y + cell.height; ++y) {
      for (int x = cell.x; x < cell.x + cell.width; ++x) share += shares.at(x, y);
    }
    bound.add(share, cell.pixels());
    tile.own += share / tile.pixels;
    tile.squares += share * share / cell.pixels();
  }
  return tile;
}

void pool(std::vector<TileError>& tiles, int columns) {
  const int rows = static_cast<int>(tiles.size()) / columns;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      double sum = 0, squares = 0, pixels = 0;  // of what one sample would leave
      for (int r = std::max(row - 1, 0); r <= std::min(row + 1, rows - 1); ++r) {
        for (int c = std::max(column - 1, 0); c <= std::min(column + 1, columns - 1); ++c) {
          const TileError& other = tiles[static_cast<std::size_t>(r) * columns + c];
          const double samples = other.samples;
          sum += other.own * samples * other.pixels;
          squares += other.squares * samples * samples;
          pixels += other.pixels;
        }
      }
      if (squares == 0) continue;
      TileError& tile = tiles[static_cast<std::size_t>(row) * columns + column];
      const double carriers = sum * sum / squares;
      tile.pooled = std::min(1.0, kFewCarriers / carriers) * sum / (pixels * tile.samples);
    }
  }
}

std::optional<Round> choose_round(const std::vector<TileError>& tiles, const ErrorGoal& goal) {
  double worst = 0;
  for (const TileError& tile : tiles) {
    if (tile.samples < goal.most_samples) worst = std::max(worst, tile.deciding());
  }
  if (worst == 0) return std::nullopt;
  // Where all tiles are below and the picture is not done yet, the worst ones go on.
  const double above = std::min(kOpenAbove * goal.rel_error * goal.rel_error, 0.5 * worst);
  Round round;
  std::uint32_t fewest = goal.most_samples;
  for (std::uint32_t i = 0; i < tiles.size(); ++i) {
    if (tiles[i].deciding() <= above || tiles[i].samples > fewest || tiles[i].samples >= goal.most_samples) continue;
    if (tiles[i].samples < fewest) round.tiles.clear();
    fewest = tiles[i].samples;
    round.tiles.push_back(i);
  }
  round.samples = {fewest, fewest > goal.most_samples / 2 ? goal.most_samples : 2 * fewest};
  return round;
}

// Carries the rounds out on paper.
double predict_samples(std::vector<TileError> tiles, const ErrorGoal& goal, double bound, double estimate) {
  const double margin = estimate > 0 && std::isfinite(bound) ? bound * bound / estimate : 1;
  double samples = 0, pixels = 0;
  for (const TileError& tile : tiles) {
    samples += tile.pixels * tile.samples;
    pixels += tile.pixels;
  }
  const auto reached = [&] {
    const double sum =
        std::accumulate(tiles.begin(), tiles.end(), 0.0, [](double s, const TileError& t) { return s + t.own * t.pixels; });
    return margin * sum / pixels <= goal.rel_error * goal.rel_error;
  };
  while (!reached()) {
    const std::optional<Round> round = choose_round(tiles, goal);
    if (!round) break;
    for (const std::uint32_t index : round->tiles) {
      samples += tiles[index].pixels * round->samples.size();
      tiles[index].take_round(round->samples.end);
    }
  }
  return samples;
}

// The goal that noise has to meet so that the whole error meets the one that was asked for. Where light that no sample can find
// would leave less than half of its square, that is out of reach, and noise is held to the goal itself.
ErrorGoal goal_for_noise(ErrorGoal goal, double unreachable) {
  const double asked = goal.rel_error * goal.rel_error, lost = unreachable * unreachable;
  if (lost > 0 && lost <= asked / 2) goal.rel_error = std::sqrt(asked - lost);
  return goal;
}

// What follows because the audit doubts tiles of a picture whose noise is low enough.
std::optional<Round> choose_doubtful(std::vector<TileError> tiles, const std::vector<std::uint32_t>& doubtful, ErrorGoal goal) {
  for (TileError& tile : tiles) tile.own = tile.pooled = 0;
  for (const std::uint32_t index : doubtful) tiles[index].own = 1;
  goal.most_samples = std::min(goal.most_samples, kMostForDoubt);
  return choose_round(tiles, goal);
}

}  // namespace

Round first_round(const ErrorGoal& goal, PixelRect crop) {
  Round round{{0, std::min(kFirstRound, goal.most_samples)}, {}};
  round.tiles.resize(make_tiles(crop, kErrorTile).size());
  std::iota(round.tiles.begin(), round.tiles.end(), 0u);
  return round;
}

ErrorLook look_at(const Film& film, const ErrorGoal& goal, int number, const LightAudit* audit) {
  const PixelRect crop = film.crop();
  const ErrorShares shares(film);
  ErrorBound bound;
  std::vector<TileError> tiles;
  for (const PixelRect& rect : make_tiles(crop, kErrorTile)) tiles.push_back(measure(film, shares, rect, bound));
  pool(tiles, (crop.width + kErrorTile - 1) / kErrorTile);
  ErrorLook look;
  const bool known = std::ranges::all_of(tiles, [](const TileError& tile) { return tile.samples >= 2; });
  const double noise = known ? bound.at(number) : std::numeric_limits<double>::infinity();
  UnseenError unseen;
  if (audit != nullptr) {
    unseen = unseen_error(film, *audit, number);
    look.unseen = unseen.error;
  }
  look.bound = std::hypot(noise, unseen.error);
  const ErrorGoal for_noise = goal_for_noise(goal, unseen.unreachable_error);
  if (noise > for_noise.rel_error) {
    look.next = choose_round(tiles, for_noise);
  } else if (look.bound > goal.rel_error) {
    look.next = choose_doubtful(tiles, unseen.doubtful, goal);
  }
  if (!look.next && look.bound > goal.rel_error && noise <= for_noise.rel_error) {
    look.warning = unseen_warning(unseen, goal.rel_error);
  }
  look.samples = predict_samples(std::move(tiles), for_noise, noise, bound.estimate());
  return look;
}

}  // namespace fluxfarm
