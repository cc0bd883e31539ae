#include "film/tile_grid.h"

#include <algorithm>

namespace fluxfarm {

std::vector<PixelRect> make_tiles(PixelRect area, int size) {
  std::vector<PixelRect> tiles;
  for (int y = area.y; y < area.y + area.height; y += size) {
    for (int x = area.x; x < area.x + area.width; x += size) {
      tiles.push_back({x, y, std::min(size, area.x + area.width - x), std::min(size, area.y + area.height - y)});
    }
  }
  return tiles;
}

}  // namespace fluxfarm
