#include "emitters/lat_long_distribution.h"

namespace fluxfarm {

LatLongDistribution::LatLongDistribution(const LatLongImage& image) {
  for (int row = 0; row < image.height; ++row) cos_theta_.push_back(std::cos(M_PI * row / (image.height - 1)));
  std::vector<double> rows, columns(static_cast<std::size_t>(image.width));
  for (int row = 0; row + 1 < image.height; ++row) {
    double sum = 0;
    for (int column = 0; column < image.width; ++column) {
      const auto weight = static_cast<double>(luminance(image.mean(column, row)));
      columns[static_cast<std::size_t>(column)] = weight;
      sum += weight;
    }
    column_choice_.emplace_back(columns);
    rows.push_back(sum * static_cast<double>(cell_solid_angle(column_choice_.size() - 1)));
  }
  row_choice_ = DiscreteDistribution(rows);
}

LatLongDistribution::Sample LatLongDistribution::sample(const LatLongImage& image, Vec2f u) const {
  const DiscreteDistribution::Choice row = row_choice_.sample(u.y);
  const DiscreteDistribution::Choice column = column_choice_[row.index].sample(u.x);
  const double upper = cos_theta_[row.index], lower = cos_theta_[row.index + 1];
  const double cos_theta = upper + static_cast<double>(row.u) * (lower - upper);
  return {image.direction(static_cast<int>(column.index), column.u, cos_theta),
          row.probability * column.probability / cell_solid_angle(row.index)};
}

float LatLongDistribution::pdf(const LatLongImage::Cell& cell) const {
  const auto row = static_cast<std::size_t>(cell.row), column = static_cast<std::size_t>(cell.column);
  return row_choice_.probability(row) * column_choice_[row].probability(column) / cell_solid_angle(row);
}

float LatLongDistribution::cell_solid_angle(std::size_t row) const {
  const double turn = 2 * M_PI / static_cast<double>(column_choice_.front().size());
  return static_cast<float>(turn * (cos_theta_[row] - cos_theta_[row + 1]));
}

}  // namespace fluxfarm
