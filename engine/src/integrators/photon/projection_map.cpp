#include "integrators/photon/projection_map.h"

#include <algorithm>
#include <numeric>

#include "integrators/light_flux.h"

namespace fluxfarm {

ProjectionMap::ProjectionMap(const Scene& scene, const std::vector<Ball>& balls)
    : scene_(scene), cells_(cells_that_meet(scene, balls)) {
  follow(std::vector<double>(cells_.kept.size()));
}

void ProjectionMap::follow(const std::vector<double>& uses) {
  double power = 0;
  for (const KeptCell& kept : cells_.kept) power += kept.power;
  const double use = std::accumulate(uses.begin(), uses.end(), 0.0);
  const double by_power = use > 0 ? 1 / kStrongest : 1;
  double sum = 0;
  upper_.clear();
  for (std::size_t i = 0; i < uses.size(); ++i) {
    sum += by_power * cells_.kept[i].power / power + (use > 0 ? (1 - by_power) * uses[i] / use : 0);
    upper_.push_back(sum);
  }
}

std::size_t ProjectionMap::cell_at(double place) const {
  const auto found = std::upper_bound(upper_.begin(), upper_.end(), place);
  return std::min(static_cast<std::size_t>(found - upper_.begin()), upper_.size() - 1);
}

double ProjectionMap::probability(std::size_t cell) const { return upper_[cell] - (cell == 0 ? 0.0 : upper_[cell - 1]); }

std::optional<EmissionSample> ProjectionMap::emit(double place, Vec2f u_point, Vec2f u_direction) const {
  const std::size_t index = cell_at(place);
  const auto& [emitter, cell, power] = cells_.kept[index];
  auto emission = ParticleSource::emit_from(scene_, emitter, cell.point.at(u_point), cell.direction.at(u_direction));
  if (emission) emission->flux = emission->flux * static_cast<float>(cell.measure() / probability(index));
  return emission;
}

}  // namespace fluxfarm
