// fluxfarm-engine bench path: how much of bare Embree's ray rate path tracing reaches, on the rays that it really traces.
//
// The rays of a few thousand paths are recorded; then rounds of path tracing and rounds of tracing the recorded rays alone take
// turns, and the medians are compared, so that a machine that slows down for a while slows down both.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

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
constexpr double kRoundSeconds = 0.3;
constexpr std::uint32_t kBenchSamples = 64;       // a pass of the usual size
constexpr std::size_t kRecordedRays = 1'000'000;  // a thread

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

class PathBench {
 public:
  PathBench(const Scene& scene, const Integrator& integrator, int threads)
      : scene_(scene),
        integrator_(integrator),
        threads_(threads),
        tiles_(make_tiles({scene.film().crop_x, scene.film().crop_y, scene.film().crop_width, scene.film().crop_height}, 32)) {}

  // One round of path tracing: rays and samples a second over all threads.
  std::pair<double, double> trace_round() {
    std::atomic<std::uint64_t> rays{0}, samples{0};
    const Clock::time_point start = Clock::now();
    on_every_thread([&](int) {
      RayQueries queries(scene_.accelerator());
      while (seconds_since(start) < kRoundSeconds) samples += trace_tile(queries);
      rays += queries.rays();
    });
    const double seconds = seconds_since(start);
    return {static_cast<double>(rays) / seconds, static_cast<double>(samples) / seconds};
  }

  void record() {
    recorded_.resize(static_cast<std::size_t>(threads_));
    on_every_thread([&](int thread) {
      std::vector<RecordedRay>& rays = recorded_[static_cast<std::size_t>(thread)];
      RayQueries queries(scene_.accelerator());
      queries.record_to(&rays);
      while (rays.size() < kRecordedRays) trace_tile(queries);
      rays.resize(kRecordedRays);
    });
  }

  // One round of tracing the recorded rays and nothing else: rays a second over all threads.
  double replay_round() {
    std::atomic<std::uint64_t> hits{0};
    const Clock::time_point start = Clock::now();
    on_every_thread([&](int thread) { hits += scene_.accelerator().replay(recorded_[static_cast<std::size_t>(thread)]); });
    const double seconds = seconds_since(start);
    if (hits == 0) throw Error("the recorded rays hit nothing: there is nothing to measure");
    return static_cast<double>(kRecordedRays) * threads_ / seconds;
  }

 private:
  void on_every_thread(const std::function<void(int)>& work) {
    parallel_for(static_cast<std::size_t>(threads_), threads_, [&](std::size_t index, int) {
      prepare_render_thread();
      work(static_cast<int>(index));
    });
  }

  std::uint64_t trace_tile(RayQueries& queries) {
    const std::uint64_t turn = turn_++;
    const PixelRect tile = tiles_[turn % tiles_.size()];
    const auto sample = static_cast<std::uint32_t>(kBenchSamples * (turn / tiles_.size()));
    render_tile(scene_, integrator_, {tile, {sample, sample + kBenchSamples}, 0}, queries, never_);
    return kBenchSamples * static_cast<std::uint64_t>(tile.pixels());
  }

  const Scene& scene_;
  const Integrator& integrator_;
  int threads_;
  std::vector<PixelRect> tiles_;
  std::atomic<std::uint64_t> turn_{0};
  std::atomic<bool> never_{false};
  std::vector<std::vector<RecordedRay>> recorded_;
};

void bench(const BenchOptions& options) {
  if (options.what != "path") throw SettingError("bench " + options.what + ", expected path");
  const int threads = resolve_threads(options.threads);
  const Scene scene(options.scene.read(), threads);
  const std::unique_ptr<Integrator> integrator = make_integrator("path", scene);
  PathBench path(scene, *integrator, threads);
  path.record();
  std::vector<double> path_rates, sample_rates, embree_rates, ratios;
  for (int round = 0; round < kRounds; ++round) {
    const auto [rays, samples] = path.trace_round();
    path_rates.push_back(rays);
    sample_rates.push_back(samples);
    embree_rates.push_back(path.replay_round());
    ratios.push_back(path_rates.back() / embree_rates.back());
  }
  const nlohmann::json result = {
      {"scene", options.scene.scene.string()},          {"threads", threads},
      {"triangles", scene.census().triangles},          {"rounds", kRounds},
      {"path_rays_per_second", median(path_rates)},     {"path_samples_per_second", median(sample_rates)},
      {"embree_rays_per_second", median(embree_rates)}, {"ratio", median(ratios)}};
  if (options.json) {
    std::printf("%s\n", result.dump(2).c_str());
    return;
  }
  std::printf("%s, %d threads, %zu triangles, medians of %d rounds\n", options.scene.scene.c_str(), threads,
              scene.census().triangles, kRounds);
  std::printf("path_rays_per_second    %.3f M\n", median(path_rates) / 1e6);
  std::printf("path_samples_per_second %.3f M\n", median(sample_rates) / 1e6);
  std::printf("embree_rays_per_second  %.3f M\n", median(embree_rates) / 1e6);
  std::printf("ratio                   %.3f\n", median(ratios));
}

}  // namespace

void add_bench_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("bench", "Measure the engine: bench [path] SCENE");
  const auto options = std::make_shared<BenchOptions>();
  const auto words = std::make_shared<std::vector<std::string>>();
  command->add_option("WHAT_AND_SCENE", *words, "What to measure (path, the default) and the scene file")
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
