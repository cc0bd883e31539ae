// fluxfarm-engine bench: path here, photons in bench_photons.h, irradiance in bench_irradiance.h.
//
// bench path: how much of bare Embree's ray rate path tracing reaches, on the rays that it really traces. The rays of tiles spread
// over the picture are recorded; then rounds of path tracing those tiles and rounds of tracing their recorded rays alone take
// turns, and the medians are compared, so that a machine that slows down for a while slows down both.
#include <atomic>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>

#include "bench_irradiance.h"
#include "bench_photons.h"
#include "bench_tools.h"
#include "commands.h"
#include "film/tile_grid.h"
#include "integrators/integrator.h"
#include "scene_options.h"
#include "support/error.h"
#include "support/parallel.h"
#include "worker/tile_runner.h"

namespace fluxfarm {
namespace {

struct BenchOptions {
  std::string what = "path";
  SceneOptions scene;
  int threads = 0;
  bool json = false;
};

constexpr int kRounds = 9;
constexpr std::uint32_t kBenchSamples = 64;       // a pass of the usual size
constexpr int kBenchTile = 8;                     // pixels; small, so that those of one thread lie all over the picture
constexpr std::size_t kRecordedRays = 1'000'000;  // a thread, at least

// The same tiles and samples in every round: each thread has its own.
class PathBench {
 public:
  PathBench(const Scene& scene, const Integrator& integrator, int threads)
      : scene_(scene), integrator_(integrator), shares_(static_cast<std::size_t>(threads)) {
    record(make_tiles({scene.film().crop_x, scene.film().crop_y, scene.film().crop_width, scene.film().crop_height}, kBenchTile));
  }

  // One round of path tracing, in seconds.
  double trace_round() {
    return on_every_thread([&](Share& share) {
      RayQueries queries(scene_.accelerator());
      for (const TileTask& task : share.tasks) render_tile(scene_, integrator_, task, queries, never_);
    });
  }

  // One round of tracing the rays of those tiles and nothing else, in seconds.
  double replay_round() {
    std::atomic<std::uint64_t> hits{0};
    const double seconds = on_every_thread([&](Share& share) { hits += scene_.accelerator().replay(share.rays); });
    if (hits == 0) throw Error("the recorded rays hit nothing: there is nothing to measure");
    return seconds;
  }

  double rays() const {
    double rays = 0;
    for (const Share& share : shares_) rays += static_cast<double>(share.rays.size());
    return rays;
  }
  double samples() const {
    double samples = 0;
    for (const Share& share : shares_) {
      for (const TileTask& task : share.tasks) samples += static_cast<double>(task.rect.pixels()) * task.samples.size();
    }
    return samples;
  }

 private:
  struct Share {
    std::vector<TileTask> tasks;
    std::vector<RecordedRay> rays;
  };

  // Gives out the tiles in an order that is spread over the picture, until each thread has its rays; from the start again with
  // later samples if there are too few tiles.
  void record(const std::vector<PixelRect>& tiles) {
    std::size_t stride = static_cast<std::size_t>(0.618 * static_cast<double>(tiles.size())) | 1;
    while (std::gcd(stride, tiles.size()) != 1) stride += 2;
    std::atomic<std::size_t> turn{0};
    on_every_thread([&](Share& share) {
      RayQueries queries(scene_.accelerator());
      queries.record_to(&share.rays);
      while (share.rays.size() < kRecordedRays) {
        const std::size_t mine = turn++;
        const auto sample = static_cast<std::uint32_t>(kBenchSamples * (mine / tiles.size()));
        share.tasks.push_back({tiles[mine * stride % tiles.size()], {sample, sample + kBenchSamples}, 0});
        render_tile(scene_, integrator_, share.tasks.back(), queries, never_);
      }
    });
  }

  // Returns the seconds until all threads are done.
  double on_every_thread(const std::function<void(Share&)>& work) {
    const BenchClock::time_point start = BenchClock::now();
    parallel_for(shares_.size(), static_cast<int>(shares_.size()), [&](std::size_t index, int) {
      prepare_render_thread();
      work(shares_[index]);
    });
    return seconds_since(start);
  }

  const Scene& scene_;
  const Integrator& integrator_;
  std::vector<Share> shares_;
  std::atomic<bool> never_{false};
};

nlohmann::json bench_path(const Scene& scene, int threads) {
  const std::unique_ptr<Integrator> integrator = make_integrator("path", scene);
  PathBench path(scene, *integrator, threads);
  std::vector<double> path_rates, sample_rates, embree_rates, ratios;
  for (int round = 0; round < kRounds; ++round) {
    const double path_seconds = path.trace_round(), embree_seconds = path.replay_round();
    path_rates.push_back(path.rays() / path_seconds);
    sample_rates.push_back(path.samples() / path_seconds);
    embree_rates.push_back(path.rays() / embree_seconds);
    ratios.push_back(embree_seconds / path_seconds);
  }
  return {{"triangles", scene.census().triangles},          {"rounds", kRounds},
          {"path_rays_per_second", median(path_rates)},     {"path_samples_per_second", median(sample_rates)},
          {"embree_rays_per_second", median(embree_rates)}, {"ratio", median(ratios)}};
}

void bench(const BenchOptions& options) {
  using Bench = nlohmann::json (*)(const Scene&, int);
  const std::map<std::string, Bench> benches{{"path", bench_path}, {"photons", bench_photons}, {"irradiance", bench_irradiance}};
  const auto found = benches.find(options.what);
  if (found == benches.end()) throw SettingError("bench " + options.what + ", expected path, photons or irradiance");
  const int threads = resolve_threads(options.threads);
  const Scene scene(options.scene.read(), threads);
  nlohmann::ordered_json result = {{"scene", options.scene.scene.string()}, {"threads", threads}};
  result.update(found->second(scene, threads));
  if (options.json) {
    std::printf("%s\n", result.dump(2).c_str());
    return;
  }
  for (const auto& [name, value] : result.items()) std::printf("%-40s %s\n", name.c_str(), value.dump().c_str());
}

}  // namespace

void add_bench_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("bench", "Measure the engine: bench [path|photons|irradiance] SCENE");
  const auto options = std::make_shared<BenchOptions>();
  const auto words = std::make_shared<std::vector<std::string>>();
  command->add_option("WHAT_AND_SCENE", *words, "What to measure (path, the default, photons or irradiance) and the scene file")
      ->required()
      ->expected(1, 2);
  command->add_option("--size", options->scene.size, "Film size WxH in pixels");
  command->add_option("--threads", options->threads, "Threads; default: all cores")->check(CLI::Range(1, 1024));
  command->add_flag("--json", options->json, "As JSON");
  command->callback([options, words] {
    options->scene.scene = words->back();
    if (words->size() == 2) options->what = words->front();
    bench(*options);
  });
}

}  // namespace fluxfarm
