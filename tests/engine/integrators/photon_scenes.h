// What the tests of photons share: replicates of an estimate, and shooting in one line.
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>
#include <vector>

#include "integrators/photon/shoot_photons.h"
#include "support/scene_builder.h"

namespace fluxfarm::testing {

// Bound on |z| of means over kReplicates: Student's t with 15 degrees of freedom passes it with probability 0.9 %. Seeds are fixed.
inline constexpr double kMaxZ = 3;
// A twin with a fault must be as far away as this at least.
inline constexpr double kTwinZ = 5;
inline constexpr int kReplicates = 16;

inline Measurement summarize(const std::vector<double>& values) {
  Measurement m;
  const auto n = static_cast<double>(values.size());
  for (const double v : values) m.mean += v / n;
  double squares = 0;
  for (const double v : values) squares += (v - m.mean) * (v - m.mean);
  m.standard_error = std::sqrt(squares / (n * (n - 1)));
  return m;
}

// Of estimate(seed), a number, over as many seeds.
template <typename Estimate>
Measurement replicated(Estimate&& estimate) {
  std::vector<double> values;
  for (std::uint64_t seed = 1; seed <= kReplicates; ++seed) values.push_back(estimate(seed));
  return summarize(values);
}

inline ShotPhotons shoot(const Scene& scene, const PhotonSettings& settings, int threads = 2) {
  static const std::atomic<bool> never{false};
  return shoot_photons(scene, PhotonTracer(scene, settings), {0, settings.photons}, std::size_t{1} << 26, threads, never);
}

}  // namespace fluxfarm::testing
