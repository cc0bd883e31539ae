#include "film/bias_error.h"

#include <algorithm>
#include <cmath>

#include "film/tile_grid.h"

namespace fluxfarm {
namespace {

// Side of the cells, in pixels: larger than the disks of density estimates.
constexpr int kCell = 8;
constexpr double kStandardErrors = 3;

}  // namespace

BiasError bias_error(const Film& film, const std::vector<PixelRect>& tiles) {
  BiasError result;
  double sum = 0, squares = 0, cells = 0, pixels = 0;
  for (const PixelRect& tile : tiles) {
    double share = 0;
    for (const PixelRect& cell : make_tiles(tile, kCell)) {
      double own = 0;
      for (int y = cell.y; y < cell.y + cell.height; ++y) {
        for (int x = cell.x; x < cell.x + cell.width; ++x) own += film.bias_share(x, y);
      }
      share += own;
      squares += own * own;
      ++cells;
    }
    sum += share;
    pixels += tile.pixels();
    result.shares.push_back(std::max(share / tile.pixels(), 0.0));
  }
  const double variance = std::max(squares - sum * sum / cells, 0.0);  // of the sum
  result.bound = std::sqrt(std::max(sum + kStandardErrors * std::sqrt(variance), 0.0) / pixels);
  return result;
}

}  // namespace fluxfarm
