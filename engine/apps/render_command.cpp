// fluxfarm-engine render: scene to EXR in this process.
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "io/exr.h"
#include "io/png.h"
#include "method_options.h"
#include "openjd.h"
#include "output_file.h"
#include "scene_options.h"
#include "support/error.h"
#include "worker/build_id.h"
#include "worker/frame_renderer.h"
#include "worker/pilot.h"
#include "worker/plan.h"

namespace fluxfarm {
namespace {

struct RenderOptions {
  SceneOptions scene;
  std::filesystem::path exr, png, report;
  std::string integrator;  // "": as the scene says
  Goal goal;
  int threads = 0, tile = 64;
  std::uint64_t seed = 0;
  bool openjd = false;
};

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set from a signal handler");
void interrupt(int) { interrupted = true; }

class Stopwatch {
 public:
  // Seconds since the last call, or since construction.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

nlohmann::json or_null(const std::optional<double>& value) { return value ? nlohmann::json(*value) : nlohmann::json(); }

void say_progress(const TimelinePoint& point) {
  if (isatty(STDERR_FILENO) == 0) return;
  std::fprintf(stderr, "\r%8.1f s  %8.6g spp  error %-10s", point.seconds, point.spp,
               point.error ? std::to_string(*point.error).c_str() : "-");
}

void write_report(const std::filesystem::path& path, const nlohmann::json& report) {
  std::ofstream out(path);
  out << report.dump(2) << '\n';
  out.flush();
  if (!out) throw ResourceError(path.string() + ": cannot write the report");
}

void render(const RenderOptions& options) {
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  OutputFile exr(options.exr);
  std::optional<OutputFile> png, report;
  if (!options.png.empty()) png.emplace(options.png);
  if (!options.report.empty()) report.emplace(options.report);
  Stopwatch watch;
  const SceneDescription description = options.scene.read();
  const double load = watch.lap();
  const int threads = resolve_threads(options.threads);
  const Scene scene(description, threads);
  const double build = watch.lap();
  for (const std::string& warning : scene.warnings()) std::fprintf(stderr, "warning: %s\n", warning.c_str());

  const FilmDescription& film = scene.film();
  FrameSettings settings{
      {film.crop_x, film.crop_y, film.crop_width, film.crop_height}, options.tile, threads, options.seed, options.goal};
  settings.goal = settled(settings.goal, description.samples_per_pixel);
  const Method method = make_method(method_for(options.integrator, options.scene.scene), scene,
                                    {settings.crop, settings.seed, settings.goal}, threads, interrupted);
  const double prepare = watch.lap();
  if (method.choice) std::fprintf(stderr, "integrator: %s (%s)\n", method.choice->method.c_str(), method.choice->reason.c_str());
  const Integrator& integrator = *method.integrator;
  OpenJdLines openjd(settings.goal);
  const auto after_pass = [&](const TimelinePoint& point) {
    say_progress(point);
    if (options.openjd) openjd.progress(point);
  };
  const FrameResult result = render_frame(scene, integrator, settings, interrupted, after_pass, method.known);
  if (isatty(STDERR_FILENO) != 0) std::fprintf(stderr, "\n");
  watch.lap();

  const Image image = result.film.image(settings.crop, {"", "", integrator.name(), engine_build_id(), options.seed});
  exr.commit([&](const std::filesystem::path& path) { write_exr(path, image); });
  if (png) png->commit([&](const std::filesystem::path& path) { write_png(path, image); });
  const double write = watch.lap();
  if (options.openjd) OpenJdLines::done();

  std::vector<std::string> warnings = scene.warnings();
  if (result.summary.non_finite_samples > 0) {
    warnings.push_back(std::to_string(result.summary.non_finite_samples) + " samples were not finite and count as zero");
    std::fprintf(stderr, "warning: %s\n", warnings.back().c_str());
  }
  for (const std::string& warning : result.warnings) {
    warnings.push_back(warning);
    std::fprintf(stderr, "warning: %s\n", warning.c_str());
  }
  if (!report) return;
  nlohmann::json timeline = nlohmann::json::array();
  for (const TimelinePoint& point : result.timeline) {
    timeline.push_back({{"seconds", point.seconds},
                        {"spp", point.spp},
                        {"error", or_null(point.error)},
                        {"expected_spp", or_null(point.expected_spp)}});
  }
  const nlohmann::json figures = {
      {"engine", engine_build_id()},
      {"integrator", integrator.name()},
      {"size", {film.width, film.height}},
      {"threads", threads},
      {"seed", options.seed},
      {"seconds", {{"load", load}, {"build", build}, {"prepare", prepare}, {"render", result.seconds}, {"write", write}}},
      {"spp", result.summary.mean_samples},
      {"samples", static_cast<std::uint64_t>(std::llround(result.summary.mean_samples * settings.crop.pixels()))},
      {"rays", result.rays},
      {"rays_per_second", static_cast<double>(result.rays) / result.seconds},
      {"mean", result.summary.mean},
      // Light that was never sampled is looked for where an error goal is to be claimed.
      {"error",
       {{"noise", or_null(result.summary.error_noise)},
        {"bias", or_null(result.summary.error_bias)},
        {"unseen", or_null(result.error_unseen)}}},
      {"timeline", timeline},
      {"plan", nlohmann::json::parse(plan_json(scene, integrator, method.choice ? &*method.choice : nullptr))},
      {"warnings", warnings}};
  report->commit([&](const std::filesystem::path& path) { write_report(path, figures); });
}

// Says why it failed in a line of its own, then fails as it would.
void render_for_openjd(const RenderOptions& options) try { render(options); } catch (const std::exception& error) {
  OpenJdLines::fail(error.what());
  throw;
}

}  // namespace

void add_render_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("render", "Render a scene to an EXR file");
  const auto options = std::make_shared<RenderOptions>();
  options->scene.add_to(*command, true);
  command->add_option("-o,--output", options->exr, "EXR file to write")->required();
  command->add_option("--png", options->png, "Also write a tone-mapped PNG");
  command->add_option("--report", options->report, "Write figures of the run as JSON");
  add_method_option(*command, options->integrator);
  add_goal_options(*command, options->goal);
  command->add_option("--threads", options->threads, "Render threads; default: all cores")->check(CLI::Range(1, 1024));
  command->add_option("--tile", options->tile, "Tile side in pixels; does not change the result")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Seed of the random numbers")->capture_default_str();
  command->add_flag("--openjd", options->openjd, "Also print progress as Open Job Description sessions read it");
  command->callback([options] { options->openjd ? render_for_openjd(*options) : render(*options); });
}

}  // namespace fluxfarm
