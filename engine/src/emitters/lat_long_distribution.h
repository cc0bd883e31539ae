// Directions in proportion to the luminance of a latitude-longitude image: a cell between four pixels is chosen with its mean
// luminance times its solid angle, and a direction evenly over that solid angle. The density is constant per steradian within a
// cell and is zero only where all four pixels are black, so that it covers the bilinear lookup.
//
// Evenly in the cosine of the polar angle rather than in the angle: sin(theta) is part of the choice, exactly, and no density
// grows without bound at the poles.
#pragma once

#include <vector>

#include "emitters/lat_long_image.h"
#include "sampling/discrete_distribution.h"
#include "sampling/warp_bounds.h"

namespace fluxfarm {

class LatLongDistribution {
 public:
  explicit LatLongDistribution(const LatLongImage& image);

  struct Sample {
    Vec3f direction;            // unit
    float pdf_solid_angle = 0;  // sr^-1; above zero unless the image is black
  };
  // `image`: the one that the distribution was made from.
  Sample sample(const LatLongImage& image, Vec2f u) const;
  // Holds the directions that sample() chooses for the u of a box.
  Cone cone(const UnitBox& box) const;
  // Density of the directions of that cell, sr^-1.
  float pdf(const LatLongImage::Cell& cell) const;

 private:
  float cell_solid_angle(std::size_t row) const;  // sr

  std::vector<double> cos_theta_;  // at the edges of the rows of cells
  DiscreteDistribution row_choice_;
  std::vector<DiscreteDistribution> column_choice_;  // for each row
};

}  // namespace fluxfarm
