#include "film/error_goal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "film/error_bound.h"
#include "film/error_shares.h"
#include "film/tile_grid.h"

namespace fluxfarm {
namespace {

// A choice: with one, tiles would end at the goal and leave no room for the confidence; smaller ones spend samples where they
// lower the picture's error little.
constexpr double kOpenAbove = 0.5;
// Side of the cells over which the carriers of the error are pooled, in pixels.
constexpr int kCell = 4;

// Below so many pixels that carry the error of a neighbourhood, a tile's own error may be that of a lucky one (a choice).
constexpr double kFewCarriers = 64;

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

TileError measure(const Film& film, PixelRect rect, ErrorBound& bound) {
  const ErrorShares shares(film, rect);
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

}  // namespace

Round first_round(const ErrorGoal& goal, PixelRect crop) {
  Round round{{0, std::min(kFirstRound, goal.most_samples)}, {}};
  round.tiles.resize(make_tiles(crop, kErrorTile).size());
  std::iota(round.tiles.begin(), round.tiles.end(), 0u);
  return round;
}

ErrorLook look_at(const Film& film, const ErrorGoal& goal, int number) {
  const PixelRect crop = film.crop();
  ErrorBound bound;
  std::vector<TileError> tiles;
  for (const PixelRect& rect : make_tiles(crop, kErrorTile)) tiles.push_back(measure(film, rect, bound));
  pool(tiles, (crop.width + kErrorTile - 1) / kErrorTile);
  ErrorLook look;
  const bool known = std::ranges::all_of(tiles, [](const TileError& tile) { return tile.samples >= 2; });
  look.bound = known ? bound.at(number) : std::numeric_limits<double>::infinity();
  if (look.bound > goal.rel_error) look.next = choose_round(tiles, goal);
  look.samples = predict_samples(std::move(tiles), goal, look.bound, bound.estimate());
  return look;
}

}  // namespace fluxfarm
