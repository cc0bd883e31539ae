#include "emitters/lat_long_distribution.h"

#include <algorithm>
#include <cmath>

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

Cone LatLongDistribution::cone(const UnitBox& box) const {
  const Vec2f end = box.last();
  const DiscreteDistribution::Choice first = row_choice_.sample(box.lower.y), last = row_choice_.sample(end.y);
  const auto theta = [&](const DiscreteDistribution::Choice& row) {
    const double upper = cos_theta_[row.index], lower = cos_theta_[row.index + 1];
    return static_cast<float>(std::acos(std::clamp(upper + static_cast<double>(row.u) * (lower - upper), -1.0, 1.0)));
  };
  const double columns = static_cast<double>(column_choice_.front().size());
  double begin = columns, stop = 0;  // of the columns that the rows choose
  for (std::size_t row = first.index; row <= last.index; ++row) {
    if (!(row_choice_.probability(row) > 0)) continue;
    const DiscreteDistribution::Choice left = column_choice_[row].sample(box.lower.x), right = column_choice_[row].sample(end.x);
    begin = std::min(begin, static_cast<double>(left.index) + static_cast<double>(left.u));
    stop = std::max(stop, static_cast<double>(right.index) + static_cast<double>(right.u));
  }
  const double step = 2 * M_PI / columns;
  const auto phi = static_cast<float>(step * (0.5 + 0.5 * (begin + stop))),
             half_phi = static_cast<float>(0.5 * step * (stop - begin));
  // The azimuth of the image starts at -z and goes to +x.
  const Cone polar = polar_cone({theta(first), theta(last), phi, half_phi});
  return {{polar.axis.y, polar.axis.z, -polar.axis.x}, polar.half_angle};
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
