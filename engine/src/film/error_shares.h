// What each pixel adds to the error of a picture: its estimated share in relMSE, the mean over channels of Var(I) / (R^2 + 1e-2).
//
// The true value R is guessed from the pixel and its neighbours. The pixel's own mean I will not do for R: a single bright sample
// raises it, which would hide the error that it makes, and where it is low by chance it exaggerates.
#pragma once

#include <vector>

#include "film/film.h"
#include "film/pixel_rect.h"

namespace fluxfarm {

// The shares of the pixels of one tile. It holds the estimates of these and of a border of one pixel only: a tile at a time, a
// picture of any size is measured in a small memory.
class ErrorShares {
 public:
  // `tile` lies in the crop of the film, in pixels of the frame.
  ErrorShares(const Film& film, PixelRect tile);

  // (x, y) of the frame, inside the tile.
  double at(int x, int y) const;

 private:
  const PixelEstimate& estimate(int x, int y) const;
  Lanes likely_value(int x, int y) const;

  PixelRect known_;  // the tile and its border
  std::vector<PixelEstimate> estimates_;
};

}  // namespace fluxfarm
