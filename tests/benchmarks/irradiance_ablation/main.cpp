// irradiance_ablation SCENE --size WxH: what the radius rule and the gradients of an irradiance cache are worth at equal records.
//
// Every place that a pixel of the film sees is gathered once; caches of each method and size take their records from these gathers,
// in random orders of the places, and are compared at all of them with an independent gather of as many paths. Prints JSON.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>

#include "ablation_cache.h"
#include "integrators/irradiance/overture.h"
#include "scene_options.h"
#include "support/error.h"
#include "support/parallel.h"

namespace fluxfarm::ablation {
namespace {

constexpr std::uint64_t kRecordSeed = 1, kReferenceSeed = 2;
constexpr float kUnused = 0;
constexpr std::size_t kOrders = 4;  // of places: errors are of as many caches

struct Options {
  SceneOptions scene;
  int strata = 64, threads = 0;
  std::vector<std::size_t> records{100, 200, 500, 1000, 2000};
  // Bounds of spacing that a split-sphere may have, in parts of the film's width: 150 pixels of 1024 [Schwarzhaupt12], and some to
  // both sides.
  std::vector<float> max_spacings{0.02f, 0.03f, 0.05f, 0.1f, 0.15f, 0.2f, 0.3f};
};

nlohmann::json row(const char* method, std::size_t wanted, const CacheOfSize& cache) {
  return {{"method", method},
          {"wanted", wanted},
          {"records", cache.records},
          {"tolerance", cache.limits.tolerance},
          {"max_spacing_pixels", cache.limits.max_spacing_pixels},
          {"rms", cache.error.rms},
          {"noise", cache.error.noise},
          {"rms_of_99", cache.error.rms_of_99},
          {"largest", cache.error.largest},
          {"covered", cache.covered}};
}

// The engine's own cache, by its overture. Empty: not to be had with so many records.
std::optional<CacheOfSize> shipped(const Scene& scene, const std::vector<GatherPlace>& places, const Halves& reference,
                                   const Options& options, std::size_t records) {
  const std::atomic<bool> never{false};
  const auto make = [&](float tolerance) {
    const CacheQuality quality{options.strata, tolerance, 2 * std::sqrt(tolerance)};
    return make_overture(scene, nullptr, nullptr, kRecordSeed, quality, options.threads, never).cache;
  };
  // Less near than the search of the other methods: a try costs seconds.
  float low = 1e-3f, high = 10;
  IrradianceCache cache;
  float tolerance = 0;
  for (int i = 0; i < 10; ++i) {
    tolerance = std::sqrt(low * high);
    cache = make(tolerance);
    const double found = static_cast<double>(cache.records().size()), goal = static_cast<double>(records);
    if (std::fabs(found - goal) <= 0.03 * goal) break;
    (found > goal ? low : high) = tolerance;
  }
  if (static_cast<double>(cache.records().size()) > 1.05 * static_cast<double>(records)) return std::nullopt;
  Found found(places.size());
  std::size_t covered = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    PlainRecord::Told told;
    bool known = true;
    for (std::uint32_t replicate = 0; replicate < kReplicates && known; ++replicate) {
      const auto part = cache.interpolate({places[i].position, places[i].frame.n, places[i].room}, replicate);
      known = part.has_value();
      if (!known) break;
      const float light = luminance(part->irradiance) / static_cast<float>(kReplicates);
      told.all += light;
      told.by_half[replicate % 2] += 2 * light;
    }
    if (!known) continue;
    found[i] = told;
    ++covered;
  }
  return CacheOfSize{static_cast<double>(cache.records().size()),
                     {tolerance, kUnused},
                     error_of(found, reference),
                     static_cast<double>(covered) / static_cast<double>(places.size())};
}

// The one of the least error among bounds of spacing: the best that the method can do, as who knows the truth would set it.
std::optional<CacheOfSize> best(const AblationCaches& caches, const Method& method, const Options& options, int width,
                                std::size_t records) {
  if (!is_bounded(method.radius)) return caches.of_size(method, kUnused, records);
  std::optional<CacheOfSize> best;
  for (const float part : options.max_spacings) {
    const auto cache = caches.of_size(method, part * static_cast<float>(width), records);
    if (cache && (!best || cache->error.rms < best->error.rms)) best = cache;
  }
  return best;
}

nlohmann::json compare(const Options& options) {
  const Scene scene(options.scene.read(), options.threads);
  const std::vector<GatherPlace> places = seen_places(scene);
  if (places.empty()) throw Error("the camera sees no diffuse surface: there is nothing to compare");
  std::fprintf(stderr, "%zu places\n", places.size());
  const std::vector<KnownPlace> known = gather_all(scene, places, options.strata, kRecordSeed, options.threads);
  const Halves truth = reference(scene, places, options.strata, kReferenceSeed, options.threads);
  std::fprintf(stderr, "gathered\n");

  double mean = 0, record_noise = 0, reference_noise = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double half = static_cast<double>(truth[i][0] - truth[i][1]) / 2, own = static_cast<double>(known[i].noise());
    mean += static_cast<double>(truth[i][0] + truth[i][1]) / (2 * static_cast<double>(places.size()));
    reference_noise += half * half / static_cast<double>(places.size());
    record_noise += own * own / static_cast<double>(places.size());
  }
  nlohmann::json result{{"scene", options.scene.scene.string()},
                        {"width", scene.film().width},
                        {"height", scene.film().height},
                        {"paths", options.strata * options.strata},
                        {"places", places.size()},
                        {"mean_irradiance", mean},
                        {"noise_of_a_record", std::sqrt(record_noise) / mean},
                        {"noise_of_the_reference", std::sqrt(reference_noise) / mean}};

  std::vector<AblationCaches::Order> orders(kOrders, AblationCaches::Order(places.size()));
  for (std::size_t i = 0; i < kOrders; ++i) {
    std::iota(orders[i].begin(), orders[i].end(), std::size_t{0});
    std::shuffle(orders[i].begin(), orders[i].end(), std::mt19937_64(i));
  }
  const AblationCaches caches(known, truth, std::move(orders), scene.radius());
  // The largest take the longest and come first.
  std::vector<std::size_t> sizes = options.records;
  std::sort(sizes.rbegin(), sizes.rend());
  std::vector<std::optional<CacheOfSize>> made(kMethods.size() * sizes.size());
  parallel_for(made.size(), options.threads, [&](std::size_t i, int) {
    made[i] = best(caches, kMethods[i % kMethods.size()], options, scene.film().width, sizes[i / kMethods.size()]);
  });
  nlohmann::json rows = nlohmann::json::array();
  for (std::size_t i = 0; i < made.size(); ++i) {
    if (made[i]) rows.push_back(row(kMethods[i % kMethods.size()].name, sizes[i / kMethods.size()], *made[i]));
  }
  std::fprintf(stderr, "compared\n");
  for (const std::size_t size : sizes) {
    if (const auto cache = shipped(scene, places, truth, options, size)) rows.push_back(row("as shipped", size, *cache));
  }
  result["rows"] = rows;
  return result;
}

int run(int argc, char** argv) {
  CLI::App app("What the radius rule and the gradients of an irradiance cache are worth at equal records");
  Options options;
  options.scene.add_to(app, false);
  app.add_option("--strata", options.strata, "Paths of a record along a side of its hemisphere: a multiple of 8")
      ->check(CLI::Range(8, 512));
  app.add_option("--records", options.records, "Sizes of caches");
  app.add_option("--max-spacings", options.max_spacings, "Bounds of a bounded split-sphere, parts of the film's width");
  app.add_option("--threads", options.threads, "Threads; default: all cores");
  CLI11_PARSE(app, argc, argv);
  options.threads = resolve_threads(options.threads);
  if (options.strata % static_cast<int>(kReplicates) != 0) {
    throw SettingError("--strata = " + std::to_string(options.strata) + ", expected a multiple of 8");
  }
  std::printf("%s\n", compare(options).dump(2).c_str());
  return 0;
}

}  // namespace
}  // namespace fluxfarm::ablation

int main(int argc, char** argv) {
  try {
    return fluxfarm::ablation::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "irradiance_ablation: %s\n", error.what());
    return 1;
  }
}
