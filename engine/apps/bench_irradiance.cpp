#include "bench_irradiance.h"

#include <atomic>
#include <vector>

#include "bench_places.h"
#include "bench_tools.h"
#include "integrators/irradiance/cache_quality.h"
#include "integrators/irradiance/cached_irradiance.h"
#include "integrators/irradiance/overture.h"

namespace fluxfarm {
namespace {

constexpr int kRounds = 5;
constexpr std::size_t kRecords = 10'000;
constexpr float kLeastTolerance = 1e-4f;

}  // namespace

nlohmann::json bench_irradiance(const Scene& scene, int threads) {
  const std::atomic<bool> never{false};
  CacheQuality quality = quality_of(cache_level({0, 1}));
  Overture overture;
  double seconds = 0;
  for (;; quality.tolerance /= 2) {
    const BenchClock::time_point start = BenchClock::now();
    overture = make_overture(scene, nullptr, nullptr, 0, quality, threads, never);
    seconds = seconds_since(start);
    if (overture.cache.records().size() >= kRecords || quality.tolerance < kLeastTolerance) break;
  }
  const IrradianceCache& cache = overture.cache;
  const std::vector<PathVertex> places = seen_places(scene, takes_irradiance);
  const int room = scene.method().max_depth < 0 ? IrradianceRecord::kMostRoom : scene.method().max_depth;
  std::vector<double> rates;
  rates.reserve(kRounds);
  std::size_t known = 0;
  for (const PathVertex& place : places) known += cache.covers(receiving_place(place, room)) ? 1 : 0;
  for (int round = 0; round < kRounds; ++round) {
    rates.push_back(asked_per_second(places, threads, [&] {
      return [&](const PathVertex& place) {
        const auto found = cache.interpolate(receiving_place(place, room), 0);
        return found ? found->irradiance : Rgb{};
      };
    }));
  }
  const auto records = static_cast<double>(cache.records().size());
  return {{"tolerance", quality.tolerance},
          {"strata", quality.strata * quality.strata},
          {"records", cache.records().size()},
          {"overture_seconds", seconds},
          {"overture_rays", overture.rays},
          {"bytes_per_record", static_cast<double>(cache.bytes()) / records},
          {"asked_places", places.size()},
          {"known_places", known},
          {"interpolations_per_second", median(rates)}};
}

}  // namespace fluxfarm
