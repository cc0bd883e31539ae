// Cutting an area into tiles.
#pragma once

#include <vector>

#include "film/pixel_rect.h"

namespace fluxfarm {

// Squares of `size` pixels from the top left corner of `area`, row by row; the last column and row are clipped.
std::vector<PixelRect> make_tiles(PixelRect area, int size);

}  // namespace fluxfarm
