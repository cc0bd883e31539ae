#include "worker/pilot_trial.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>

#include "film/error_goal.h"
#include "film/error_shares.h"
#include "film/pass_schedule.h"
#include "film/tile_grid.h"
#include "integrators/light_history.h"
#include "support/parallel.h"
#include "worker/tile_runner.h"

namespace fluxfarm {
namespace {

constexpr std::size_t kOneTileOf = 10, kFewestTiles = 6, kMostTiles = 64;

// Side of the cells in which noise is looked at, in pixels, and the part of them, one at least, whose noise counts no more than
// that of the largest other: a single bright sample, which all methods may have met, would outweigh all others. On veach-mis such
// samples make the noise of 8 samples 0.5 or 50, by chance.
constexpr int kCell = 8;
constexpr double kCapped = 0.01;

// Adds up `value(x, y)` over all pixels.
template <typename Value>
double sum_over(PixelRect rect, Value value) {
  double sum = 0;
  for (int y = rect.y; y < rect.y + rect.height; ++y) {
    for (int x = rect.x; x < rect.x + rect.width; ++x) sum += value(x, y);
  }
  return sum;
}

// As in relMSE, of a deviation's square: the mean over the channels.
double relative(const std::array<double, 3>& squares, const Lanes& mean) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double value = mean[c];
    sum += squares[c] / (value * value + 1e-2) / 3;
  }
  return sum;
}

// Of a cell, means over its pixels.
struct CellNoise {
  std::size_t tile;
  int pixels;
  double share;         // of relMSE
  double indirect = 0;  // the part of it by indirect light
};

// Light that came by a diffuse surface before the last, as far as the layers tell: the specular one has all that is seen in mirrors
// and through glass.
Rgb indirect_light(const Film& film, int x, int y) {
  return film.layer_mean(x, y, LightLayer::kIndirect) + film.layer_mean(x, y, LightLayer::kSpecular);
}

// Lessens the largest ones so that none has more noise than the largest of the others.
void cap(std::vector<CellNoise>& cells) {
  const auto capped = static_cast<std::size_t>(std::max(std::round(kCapped * static_cast<double>(cells.size())), 1.0));
  const auto next = cells.begin() + static_cast<std::ptrdiff_t>(std::min(capped, cells.size() - 1));
  std::ranges::nth_element(cells, next, std::greater{}, &CellNoise::share);
  const double most = next->share;
  for (CellNoise& cell : cells) {
    if (!(cell.share > most)) continue;
    cell.indirect *= most / cell.share;
    cell.share = most;
  }
}

}  // namespace

double PilotTask::tried_pixels() const {
  double pixels = 0;
  for (const PixelRect& tile : tiles) pixels += tile.pixels();
  return pixels;
}

std::vector<PixelRect> pilot_tiles(PixelRect crop) {
  const std::vector<PixelRect> all = make_tiles(crop, kErrorTile);
  const std::size_t wanted = std::min(std::clamp(all.size() / kOneTileOf, kFewestTiles, kMostTiles), all.size());
  const auto columns = static_cast<std::size_t>((crop.width + kErrorTile - 1) / kErrorTile);
  const std::size_t rows = all.size() / columns;
  // Places of the R2 sequence, which fill the square evenly however many they are.
  constexpr double kStepX = 0.7548776662466927, kStepY = 0.5698402909980532;
  std::vector<PixelRect> tiles;
  for (double x = 0.5, y = 0.5; tiles.size() < wanted; x = std::fmod(x + kStepX, 1), y = std::fmod(y + kStepY, 1)) {
    const PixelRect& tile = all[static_cast<std::size_t>(y * static_cast<double>(rows)) * columns +
                                static_cast<std::size_t>(x * static_cast<double>(columns))];
    if (std::ranges::find(tiles, tile) == tiles.end()) tiles.push_back(tile);
  }
  return tiles;
}

PilotTrial::PilotTrial(const PilotTask& task, const Integrator& integrator)
    : task_(task), integrator_(integrator), kept_(task.seed) {
  const Scene& scene = task.scene;
  for (const PixelRect& tile : task.tiles) {
    films_.emplace_back(scene.film().width, scene.film().height, tile, light_layers(scene.census()),
                        integrator.bias() != Integrator::Bias::kNone);
  }
}

void PilotTrial::advance(std::uint32_t samples) {
  const auto start = std::chrono::steady_clock::now();
  while (done_ < samples) {
    const SampleRange range = next_pass(done_, samples);
    const std::shared_ptr<const PreparedPass> pass = integrator_.prepare_pass(task_.seed, range, task_.threads, task_.cancelled);
    if (pass) (done_ == 0 ? rays_ahead_ : rays_of_passes_) += pass->rays();
    std::vector<TileSums> sums(films_.size());
    std::vector<std::uint64_t> rays(films_.size());
    parallel_for(films_.size(), task_.threads, [&](std::size_t i, int) {
      prepare_render_thread();
      RayQueries queries(task_.scene.accelerator());
      const TileTask tile{films_[i].crop(), range, task_.seed, pass.get()};
      sums[i] = render_tile(task_.scene, integrator_, tile, queries, task_.cancelled);
      films_[i].merge(sums[i]);
      rays[i] = queries.rays();
    });
    for (const std::uint64_t of_tile : rays) rays_of_tiles_ += of_tile;
    for (TileSums& tile : sums) kept_.keep(std::move(tile));
    kept_.keep(range, pass);
    done_ = range.end;
  }
  seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::vector<TileNoise> PilotTrial::noise() const {
  std::vector<CellNoise> cells;
  std::vector<TileNoise> tiles;
  for (std::size_t tile = 0; tile < films_.size(); ++tile) {
    const PixelRect crop = films_[tile].crop();
    const ErrorShares errors(films_[tile], crop);
    for (const PixelRect& rect : make_tiles(crop, kCell)) {
      const double sum = sum_over(rect, [&](int x, int y) { return errors.at(x, y); });
      cells.push_back({tile, rect.pixels(), sum / rect.pixels()});
    }
    tiles.push_back({0, crop.pixels()});
  }
  cap(cells);
  for (const CellNoise& cell : cells) tiles[cell.tile].share += cell.share * cell.pixels / tiles[cell.tile].pixels;
  return tiles;
}

double PilotTrial::bias() const {
  if (integrator_.bias() == Integrator::Bias::kNone) return 0;
  double sum = 0;
  for (const Film& film : films_) sum += sum_over(film.crop(), [&](int x, int y) { return film.bias_share(x, y); });
  return std::max(sum / task_.tried_pixels(), 0.0);
}

double PilotTrial::caustic_square(double brightness) const {
  if (!task_.scene.census().delta_lobes) return 0;
  double sum = 0;
  for (const Film& film : films_) {
    sum += sum_over(film.crop(), [&](int x, int y) {
      const Rgb caustic = film.layer_mean(x, y, LightLayer::kCaustic);
      const auto square = [&](float light) { return std::max(static_cast<double>(light), 0.0) * brightness; };
      return relative({square(caustic.r), square(caustic.g), square(caustic.b)}, film.estimate(x, y).mean);
    });
  }
  return sum / task_.tried_pixels();
}

double PilotTrial::rays_per_sample() const {
  const double of_tiles = static_cast<double>(rays_of_tiles_) / done_ * task_.crop.pixels() / task_.tried_pixels();
  return of_tiles + (done_ > 1 ? static_cast<double>(rays_of_passes_) / (done_ - 1) : 0);
}

double indirect_share(const std::vector<Film>& half, const std::vector<Film>& all) {
  const auto square = [](float difference) { return static_cast<double>(difference) * static_cast<double>(difference); };
  std::vector<CellNoise> cells;
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (const PixelRect& rect : make_tiles(all[i].crop(), kCell)) {
      const double indirect = sum_over(rect, [&](int x, int y) {
        const Rgb layer = indirect_light(all[i], x, y) - indirect_light(half[i], x, y);
        return relative({square(layer.r), square(layer.g), square(layer.b)}, all[i].estimate(x, y).mean);
      });
      const double share = sum_over(rect, [&](int x, int y) {
        const Lanes mean = all[i].estimate(x, y).mean, first = half[i].estimate(x, y).mean;
        return relative({square(mean[0] - first[0]), square(mean[1] - first[1]), square(mean[2] - first[2])}, mean);
      });
      cells.push_back({i, rect.pixels(), share / rect.pixels(), indirect / rect.pixels()});
    }
  }
  cap(cells);
  double indirect = 0, whole = 0;
  for (const CellNoise& cell : cells) {
    indirect += cell.indirect * cell.pixels;
    whole += cell.share * cell.pixels;
  }
  return whole > 0 ? std::min(indirect / whole, 1.0) : 0;
}

}  // namespace fluxfarm
