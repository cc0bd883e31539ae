#include "film/error_goal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <sstream>

#include "film/bias_error.h"
#include "film/error_bound.h"
#include "film/error_shares.h"
#include "film/tile_grid.h"
#include "film/unseen_error.h"

namespace fluxfarm {
namespace {

// Tiles whose samples gain so little of what the best ones gain wait (a choice: two doublings): how much they should take depends
// on variances of the others that more samples may correct.
constexpr double kFarBehind = 1.0 / 16;

// Side of the cells over which the carriers of the error are pooled, in pixels.
constexpr int kCell = 4;

// Below so many pixels that carry the error of a neighbourhood, a tile's own error may be that of a lucky one (a choice).
constexpr double kFewCarriers = 64;

// Variances fall as samples^-fall: as 1 / samples where these are random, and faster where stratification helps and the guess of
// the true values gets better. Measured between looks on cornell, cornell-glass, cornell-box and furnace: 1.0 to 1.3. On veach-mis,
// where later samples find brighter paths, it goes down to 0.
constexpr double kSlowestFall = 1.0, kFastestFall = 1.3;

struct TileError {
  std::uint32_t samples = 0;  // of each pixel
  ErrorBound cells;
  double pooled = 0;  // the mean share of relMSE that the neighbours make likely

  double own() const { return cells.estimate(); }
  double pixels() const { return cells.pixels(); }
  double deciding() const { return std::max(own(), pooled); }
  // Share of relMSE that one sample of each pixel would leave.
  double variance() const { return deciding() * samples; }
  // How much share one more sample takes off, by the derivative.
  double gain() const { return deciding() / samples; }
};

TileError measure(const Film& film, PixelRect rect) {
  const ErrorShares shares(film, rect);
  TileError tile;
  tile.samples = film.samples(rect.x, rect.y);
  for (const PixelRect& cell : make_tiles(rect, kCell)) {
    double share = 0;
    for (int y = cell.y; y < cell.y + cell.height; ++y) {
      for (int x = cell.x; x < cell.x + cell.width; ++x) share += shares.at(x, y);
    }
    tile.cells.add(share, cell.pixels());
  }
  return tile;
}

// Upper bound of sqrt(relMSE) of the whole picture at look `number`.
double error_bound(const std::vector<TileError>& tiles, int number) {
  ErrorBound picture;
  for (const TileError& tile : tiles) picture.add(tile.cells);
  return picture.at(number);
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
          sum += other.own() * samples * other.pixels();
          squares += other.cells.squares() * samples * samples;
          pixels += other.pixels();
        }
      }
      if (squares == 0) continue;
      TileError& tile = tiles[static_cast<std::size_t>(row) * columns + column];
      const double carriers = sum * sum / squares;
      tile.pooled = std::min(1.0, kFewCarriers / carriers) * sum / (pixels * tile.samples);
    }
  }
}

// The smallest gain at which tiles take more samples so that the goal's mean share is left with the fewest samples in all. With
// variances v and samples n the sum of v / n is least for a given sum of n where v / n^2, the gain, is the same in all tiles;
// tiles that have more samples than that keep them.                                                          [Neyman34]
double gain_to_keep(const std::vector<TileError>& tiles, const ErrorGoal& goal) {
  double pixels = 0, deviations = 0;
  for (const TileError& tile : tiles) {
    pixels += tile.pixels();
    deviations += tile.pixels() * std::sqrt(tile.variance());
  }
  // Samples per deviation, n / sqrt(v), by bisection from above: without the samples that are there already it would be `most`.
  const double share = goal.rel_error * goal.rel_error * pixels;
  double fewest = 0, most = deviations / share;
  for (int i = 0; i < 20; ++i) {
    const double middle = 0.5 * (fewest + most);
    double left = 0;
    for (const TileError& tile : tiles) {
      const double variance = tile.variance();
      if (variance > 0) left += tile.pixels() * variance / std::max<double>(tile.samples, middle * std::sqrt(variance));
    }
    (left > share ? fewest : most) = middle;
  }
  return 1 / (most * most);
}

std::optional<Round> choose_round(const std::vector<TileError>& tiles, const ErrorGoal& goal) {
  double best = 0;
  for (const TileError& tile : tiles) {
    if (tile.samples < goal.most_samples) best = std::max(best, tile.gain());
  }
  if (best == 0) return std::nullopt;
  // Samples double, so a tile goes on while the middle of its doubling, on the scale of logarithms, is not too much. Where none
  // is left and the picture is not done yet, as its bound lies above its error, the best ones go on.
  const double above = std::clamp(2 * gain_to_keep(tiles, goal), kFarBehind * best, 0.5 * best);
  Round round;
  std::uint32_t fewest = goal.most_samples;
  for (std::uint32_t i = 0; i < tiles.size(); ++i) {
    if (tiles[i].gain() <= above || tiles[i].samples > fewest || tiles[i].samples >= goal.most_samples) continue;
    if (tiles[i].samples < fewest) round.tiles.clear();
    fewest = tiles[i].samples;
    round.tiles.push_back(i);
  }
  round.samples = {fewest, fewest > goal.most_samples / 2 ? goal.most_samples : 2 * fewest};
  return round;
}

// Carries the rounds after look `number` out on paper: camera samples of the whole picture when its bound meets the goal, if
// variances fall as samples^-fall.
double samples_in_all(std::vector<TileError> tiles, const ErrorGoal& goal, int number, double fall) {
  double samples = 0;
  for (const TileError& tile : tiles) samples += tile.pixels() * tile.samples;
  while (error_bound(tiles, number) > goal.rel_error) {
    const std::optional<Round> round = choose_round(tiles, goal);
    if (!round) break;
    const double left = std::pow(static_cast<double>(round->samples.begin) / round->samples.end, fall);
    for (const std::uint32_t index : round->tiles) {
      TileError& tile = tiles[index];
      samples += tile.pixels() * round->samples.size();
      tile.samples = round->samples.end;
      tile.cells.scale(left);
      tile.pooled *= left;
    }
    ++number;
  }
  return samples;
}

// Rounds double samples, so a percent of error may decide on a whole one. Between the two outcomes lies what is wrong by the
// smallest factor whichever comes.
double predict_samples(const std::vector<TileError>& tiles, const ErrorGoal& goal, int number) {
  return std::sqrt(samples_in_all(tiles, goal, number, kSlowestFall) * samples_in_all(tiles, goal, number, kFastestFall));
}

// The goal that noise has to meet so that the whole error meets the one that was asked for. Where light that no sample can find
// would leave less than half of its square, that is out of reach, and noise is held to the goal itself.
ErrorGoal goal_for_noise(ErrorGoal goal, double unreachable) {
  const double asked = goal.rel_error * goal.rel_error, lost = unreachable * unreachable;
  if (lost > 0 && lost <= asked / 2) goal.rel_error = std::sqrt(asked - lost);
  return goal;
}

ErrorGoal goal_for_doubt(ErrorGoal goal) {
  goal.most_samples = std::min(goal.most_samples, kMostForDoubt);
  return goal;
}

// What follows where noise is low enough and the method's bias is not: it falls as samples are added.
std::optional<Round> choose_biased(std::vector<TileError> tiles, const std::vector<double>& shares, const ErrorGoal& goal) {
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    tiles[i].cells.scale(0);
    tiles[i].pooled = shares[i];
  }
  return choose_round(tiles, goal_for_doubt(goal));
}

std::string bias_warning(double bias, double goal) {
  std::ostringstream text;
  text.precision(2);
  text << "goal not reached: the method blurs the picture, which leaves a relative error of up to " << bias << " where " << goal
       << " was asked; ask for integrator photon-progressive or path, or for a larger error";
  return text.str();
}

// What follows because the audit doubts tiles of a picture whose noise is low enough.
std::optional<Round> choose_doubtful(std::vector<TileError> tiles, const std::vector<std::uint32_t>& doubtful,
                                     const ErrorGoal& goal) {
  for (TileError& tile : tiles) {
    tile.cells.scale(0);
    tile.pooled = 0;
  }
  for (const std::uint32_t index : doubtful) tiles[index].pooled = 1;
  return choose_round(tiles, goal_for_doubt(goal));
}

// Camera samples that doubtful tiles still take, at most: nobody knows after which the paths find what is missing.
double samples_for_doubt(const std::vector<TileError>& tiles, const std::vector<std::uint32_t>& doubtful, const ErrorGoal& goal) {
  const std::uint32_t most = goal_for_doubt(goal).most_samples;
  double samples = 0;
  for (const std::uint32_t index : doubtful) samples += tiles[index].pixels() * (most - std::min(most, tiles[index].samples));
  return samples;
}

}  // namespace

Round first_round(const ErrorGoal& goal, PixelRect crop) {
  Round round{{0, std::min(kFirstRound, goal.most_samples)}, {}};
  round.tiles.resize(make_tiles(crop, kErrorTile).size());
  std::iota(round.tiles.begin(), round.tiles.end(), 0u);
  return round;
}

ErrorLook look_at(const Film& film, const ErrorGoal& goal, int number, const LightAudit* audit, bool bias_falls) {
  const PixelRect crop = film.crop();
  const std::vector<PixelRect> rects = make_tiles(crop, kErrorTile);
  std::vector<TileError> tiles;
  tiles.reserve(rects.size());
  for (const PixelRect& rect : rects) tiles.push_back(measure(film, rect));
  pool(tiles, (crop.width + kErrorTile - 1) / kErrorTile);
  ErrorLook look;
  const bool known = std::ranges::all_of(tiles, [](const TileError& tile) { return tile.samples >= 2; });
  const double noise = known ? error_bound(tiles, number) : std::numeric_limits<double>::infinity();
  UnseenError unseen;
  const LightAudit::Outcome outcome = audit != nullptr ? audit->outcome : LightAudit::kAudited;
  if (outcome == LightAudit::kNotPossibleWithUnreachable) {
    unseen.error = unseen.unreachable_error = 1;  // all light may be missing
  } else if (audit != nullptr && outcome == LightAudit::kAudited) {
    unseen = unseen_error(film, *audit, number);
    look.unseen = unseen.error;
  }
  BiasError bias;
  if (film.biased() && known) bias = bias_error(film, rects);
  look.bound = std::hypot(std::hypot(noise, unseen.error), bias.bound);
  const ErrorGoal for_noise = goal_for_noise(goal, std::hypot(unseen.unreachable_error, bias.bound));
  look.samples = predict_samples(tiles, for_noise, number);
  if (noise > for_noise.rel_error) {
    look.next = choose_round(tiles, for_noise);
  } else if (look.bound > goal.rel_error) {
    // Where no sample can save the claim, none is spent on what samples may find.
    const bool by_bias = bias.bound > unseen.error;
    if (unseen.unreachable_error < goal.rel_error && (bias_falls || bias.bound < goal.rel_error)) {
      if (by_bias && bias_falls) look.next = choose_biased(tiles, bias.shares, goal);
      if (!look.next) look.next = choose_doubtful(tiles, unseen.doubtful, goal);
    }
    if (look.next) {
      look.samples += samples_for_doubt(tiles, unseen.doubtful, goal);
    } else {
      look.warning = by_bias       ? bias_warning(bias.bound, goal.rel_error)
                     : look.unseen ? unseen_warning(unseen, goal.rel_error)
                                   : unclaimed_warning();
    }
  } else if (outcome != LightAudit::kAudited) {
    look.warning = unaudited_warning();
  }
  return look;
}

}  // namespace fluxfarm
