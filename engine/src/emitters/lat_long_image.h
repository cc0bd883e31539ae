// Radiance from every direction as a latitude-longitude image, in Mitsuba 3's convention: +y is up, the middle of the image looks
// along +z, a quarter from the left along +x. The first row of pixels lies at the upper pole and the last at the lower one, so rows
// are pi / (height - 1) apart; columns are centred in their share of the turn and go round. In between: bilinear.
#pragma once

#include <cstddef>
#include <vector>

#include "math/rgb.h"
#include "math/vec.h"

namespace fluxfarm {

struct LatLongImage {
  int width = 0, height = 0;  // at least 1 x 2 for a lookup
  std::vector<Rgb> pixels;    // row-major from the top, W m^-2 sr^-1

  Rgb pixel(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }

  // Four neighbouring pixels and the place between them.
  struct Cell {
    int column = 0, row = 0;  // its upper left pixel; the column after the last is the first
    float x = 0, y = 0;       // from that pixel to the next, in [0, 1]
  };
  // The cell that a unit direction falls into.
  Cell cell(Vec3f direction) const;
  // The unit direction at that share `x` of a column of cells and that cosine of the polar angle.
  Vec3f direction(int column, float x, double cos_theta) const;

  // Radiance from there.
  Rgb radiance(const Cell& cell) const;
  // Mean of the four corners of a cell.
  Rgb mean(int column, int row) const;

 private:
  int next(int column) const { return column + 1 == width ? 0 : column + 1; }
};

}  // namespace fluxfarm
