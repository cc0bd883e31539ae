#include "bench_photons.h"

#include <atomic>
#include <cstdint>
#include <limits>
#include <vector>

#include "bench_places.h"
#include "bench_tools.h"
#include "integrators/path/path_vertex.h"
#include "integrators/photon/density_estimate.h"
#include "integrators/photon/density_kernel.h"
#include "integrators/photon/shoot_photons.h"
#include "nanoflann_map.h"
#include "support/error.h"
#include "support/parallel.h"

namespace fluxfarm {
namespace {

constexpr int kRounds = 5;
constexpr std::uint64_t kShot = 1'000'000;
constexpr std::size_t kInMap = 1'000'000;  // photons, about
constexpr std::size_t kNearest = 100;
constexpr std::size_t kMaxStored = std::size_t{1} << 27;

constexpr float kFar = 1e18f;  // m

#ifdef FLUXFARM_NANOFLANN
// The estimates of density_estimate.h by nanoflann's search, with the same tests and kernel.
Rgb nanoflann_nearest(const NanoflannMap& map, const PathVertex& place, NanoflannMap::Workspace& space) {
  const SurfacePatch patch(place, kFar);
  Rgb sum;
  float radius_squared = 0;
  map.nearest(patch.position(), kNearest, space, [&](const Photon& photon, float distance_squared) {
    if (patch.accepts(photon.position - patch.position(), photon.light)) sum += photon.light.flux();
    radius_squared = distance_squared;
  });
  return sum * (kInvPi / radius_squared);
}

Rgb nanoflann_within(const NanoflannMap& map, const PathVertex& place, float radius, NanoflannMap::Workspace& space) {
  const SurfacePatch patch(place, radius);
  Rgb sum;
  map.within(patch.position(), radius, space, [&](const Photon& photon, float) {
    if (patch.accepts(photon.position - patch.position(), photon.light)) sum += photon.light.flux();
  });
  return sum * (kInvPi / (radius * radius));
}
#endif

}  // namespace

nlohmann::json bench_photons(const Scene& scene, int threads) {
  const std::atomic<bool> never{false};
  const auto shoot = [&](std::uint64_t photons) {
    return shoot_photons(scene, PhotonTracer(scene, {.photons = photons}), {0, photons}, kMaxStored, threads, never);
  };
  std::vector<double> shot_rates, build_seconds;
  double stored_each = 0, rays_each = 0;
  for (int round = 0; round < kRounds; ++round) {
    const BenchClock::time_point start = BenchClock::now();
    const ShotPhotons shot = shoot(kShot);
    shot_rates.push_back(static_cast<double>(kShot) / seconds_since(start));
    stored_each = static_cast<double>(shot.photons.size()) / static_cast<double>(kShot);
    rays_each = static_cast<double>(shot.rays) / static_cast<double>(kShot);
  }
  if (!(stored_each > 0)) throw Error("no photon met a surface: there is nothing to measure");

  const std::vector<Photon> photons = shoot(static_cast<std::uint64_t>(static_cast<double>(kInMap) / stored_each) + 1).photons;
  PhotonMap map;
  for (int round = 0; round < kRounds; ++round) {
    const BenchClock::time_point start = BenchClock::now();
    map = PhotonMap(photons, threads);
    build_seconds.push_back(seconds_since(start));
  }

  const std::vector<PathVertex> places =
      seen_places(scene, [](const Scene::Surface& surface) { return surface.has_continuous_lobe; });
  // The radius within which there are usually so many photons, for the estimates by radius.
  std::vector<double> radii;
  NearestPhotons found;
  for (std::size_t i = 0; i < places.size(); i += 100) {
    const SurfacePatch patch(places[i], kFar);
    radii.push_back(static_cast<double>(estimate_by_nearest(map, patch, kNearest, kFar, BoxKernel{}, found).radius));
  }
  const auto radius = static_cast<float>(median(radii));
  const auto nearest_rate = [&] {
    return asked_per_second(places, threads, [&] {
      return [&, workspace = NearestPhotons()](const PathVertex& place) mutable {
        return estimate_by_nearest(map, {place, kFar}, kNearest, kFar, BoxKernel{}, workspace).value;
      };
    });
  };
  const auto within_rate = [&] {
    return asked_per_second(places, threads, [&] {
      return [&](const PathVertex& place) { return estimate_within(map, {place, radius}, radius, BoxKernel{}).value; };
    });
  };
  std::vector<double> nearest_rates, within_rates;
#ifdef FLUXFARM_NANOFLANN
  const BenchClock::time_point start = BenchClock::now();
  const NanoflannMap other(photons);
  const double other_build_seconds = seconds_since(start);
  std::vector<double> other_nearest_rates, other_within_rates;
#endif
  for (int round = 0; round < kRounds; ++round) {
    nearest_rates.push_back(nearest_rate());
    within_rates.push_back(within_rate());
#ifdef FLUXFARM_NANOFLANN
    const auto other_rate = [&](auto&& estimate) {
      return asked_per_second(places, threads, [&] {
        return [&, space = NanoflannMap::Workspace()](const PathVertex& place) mutable { return estimate(place, space); };
      });
    };
    other_nearest_rates.push_back(
        other_rate([&](const PathVertex& place, auto& space) { return nanoflann_nearest(other, place, space); }));
    other_within_rates.push_back(
        other_rate([&](const PathVertex& place, auto& space) { return nanoflann_within(other, place, radius, space); }));
#endif
  }
  nlohmann::json result = {{"shot_photons_per_second", median(shot_rates)},
                           {"stored_per_shot_photon", stored_each},
                           {"rays_per_shot_photon", rays_each},
                           {"photons_in_map", photons.size()},
                           {"map_bytes", map.bytes()},
                           {"map_build_seconds", median(build_seconds)},
                           {"photons_per_estimate", kNearest},
                           {"nearest_estimates_per_second", median(nearest_rates)},
                           {"radius_m", radius},
                           {"radius_estimates_per_second", median(within_rates)}};
#ifdef FLUXFARM_NANOFLANN
  result["nanoflann_build_seconds"] = other_build_seconds;
  result["nanoflann_nearest_estimates_per_second"] = median(other_nearest_rates);
  result["nanoflann_radius_estimates_per_second"] = median(other_within_rates);
  result["nearest_ratio"] = median(nearest_rates) / median(other_nearest_rates);
  result["radius_ratio"] = median(within_rates) / median(other_within_rates);
#else
  result["nanoflann"] = "left out: its header (libnanoflann-dev) was not there at the build";
#endif
  return result;
}

}  // namespace fluxfarm
