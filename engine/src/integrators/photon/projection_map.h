// Where on the emitters photons of a kind have to start: elsewhere they are not worth a ray.
//
// [Jensen96] H. W. Jensen, "Global Illumination using Photon Maps", EGWR 1996: projection maps.
//
// Cells of the emitters that cannot shine on the surfaces in question are masked, whatever stands in between; the others share the
// photons, across all emitters. No light is lost: what is masked makes no photon of the kind, and flux is divided by the density
// with which it starts, so that the mean does not depend on the densities. They follow the power of the cells, which makes photons
// equally strong, or their measured use (projection_pilot.h).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "integrators/photon/emission_cells.h"

namespace fluxfarm {

class ProjectionMap {
 public:
  // For photons that are stored only if the first surface that scatters them lies in one of the balls (bounding_balls.h). The scene
  // must outlive this.
  ProjectionMap(const Scene& scene, const std::vector<Ball>& balls);

  // Photons start in proportion to `uses`, one number for each of cells(), but for a part that goes on as power has it: no photon
  // is stronger than kStrongest times what it would be without this. All zero: as power has it.
  void follow(const std::vector<double>& uses);
  static constexpr double kStrongest = 5;

  // As ParticleSource::emit(). The map must not be empty.
  std::optional<EmissionSample> emit(double place, Vec2f u_point, Vec2f u_direction) const;

  bool empty() const { return cells_.kept.empty(); }
  std::span<const KeptCell> cells() const { return cells_.kept; }
  std::size_t cell_at(double place) const;             // index of the one that emit() takes
  double probability(std::size_t cell) const;          // of that
  double left_out() const { return cells_.left_out; }  // power that makes no photon, W

 private:
  const Scene& scene_;
  EmissionCells cells_;
  std::vector<double> upper_;  // cumulative probability up to and with each cell
};

}  // namespace fluxfarm
