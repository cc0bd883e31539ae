#include "integrators/photon/projection_pilot.h"

#include <cmath>
#include <cstdint>

#include "integrators/key_random.h"
#include "integrators/photon/bounding_balls.h"

namespace fluxfarm {
namespace {

constexpr std::uint64_t kPhotons = 16384, kSeed = 0x70696c6f74;
// A cell is taken for as useful as its emitter in the mean until it has had more photons than that.
constexpr double kPrior = 4;

// Squared flux over the density of the photons that brought it, W^2, and their number.
struct Use {
  double squares = 0, photons = 0;

  void add(const Use& other) {
    squares += other.squares;
    photons += other.photons;
  }
  double mean_square() const { return photons > 0 ? squares / photons : 0; }
};

std::vector<Use> measured(const Scene& scene, const PhotonSettings& settings, const ProjectionMap& map) {
  const PhotonTracer tracer(scene, settings, map);
  std::vector<Use> uses(map.cells().size());
  RayQueries queries(scene.accelerator());
  const auto cell_of = [&](std::uint64_t photon) {
    KeyRandom random(settings.seed, KeyRandom::kPhoton, photon);
    return map.cell_at(tracer.place(photon, random));
  };
  StoredPhotons stored;
  FluxLedger ledger;
  for (std::uint64_t first = 0, end = 0; first < settings.photons; first = end) {  // photons of one cell at a time
    const std::size_t cell = cell_of(first);
    for (end = first + 1; end < settings.photons && end < first + PhotonTracer::kGroup && cell_of(end) == cell;) ++end;
    stored.photons.clear();
    stored.in_media.clear();
    tracer.trace(first, end - first, queries, stored, ledger);
    const double density = map.probability(cell) / map.cells()[cell].cell.measure() * static_cast<double>(settings.photons);
    Use use{0, static_cast<double>(end - first)};
    for (const std::vector<Photon>* photons : {&stored.photons, &stored.in_media}) {
      for (const Photon& photon : *photons) {
        const double flux = static_cast<double>(mean(photon.light.flux())) * density;
        use.squares += flux * flux;
      }
    }
    uses[cell].add(use);
  }
  return uses;
}

}  // namespace

void follow_measured_use(const Scene& scene, const PhotonSettings& settings, ProjectionMap& map) {
  if (map.empty()) return;
  PhotonSettings pilot = settings;
  pilot.photons = kPhotons;
  pilot.seed = kSeed;
  const std::vector<Use> uses = measured(scene, pilot, map);
  std::vector<Use> of_emitter(ParticleSource::powers(scene).size());
  for (std::size_t i = 0; i < uses.size(); ++i) of_emitter[map.cells()[i].emitter].add(uses[i]);
  std::vector<double> densities;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    const auto& [emitter, cell, power] = map.cells()[i];
    Use use = uses[i];
    use.add({kPrior * of_emitter[emitter].mean_square(), kPrior});
    densities.push_back(cell.measure() * std::sqrt(use.mean_square()));
  }
  map.follow(densities);
}

ProjectionMap caustic_projection(const Scene& scene, const PhotonSettings& settings) {
  ProjectionMap map(scene, bounding_balls(scene, glossy_shapes(scene)));
  follow_measured_use(scene, settings, map);
  return map;
}

}  // namespace fluxfarm
