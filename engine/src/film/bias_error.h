// The error that a method's own bias makes in a picture, from what its samples tell of it.
#pragma once

#include <vector>

#include "film/film.h"
#include "film/pixel_rect.h"

namespace fluxfarm {

struct BiasError {
  // Upper bound of sqrt(relMSE) by bias: three standard errors above its estimate, taking cells of pixels for independent.
  double bound = 0;
  std::vector<double> shares;  // of relMSE, mean over the pixels of each tile; not below 0
};

// Of a biased film, every pixel of which has two samples at least; `tiles` cover its crop.
BiasError bias_error(const Film& film, const std::vector<PixelRect>& tiles);

}  // namespace fluxfarm
