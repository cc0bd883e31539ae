// fluxfarm-engine plan, info, worker: the short commands.
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "accel/ray_accelerator.h"
#include "commands.h"
#include "film/pass_schedule.h"
#include "method_options.h"
#include "scene_options.h"
#include "support/build_info.h"
#include "support/error.h"
#include "worker/build_id.h"
#include "worker/messages.h"
#include "worker/pilot.h"
#include "worker/plan.h"
#include "worker/sandbox.h"
#include "worker/worker_process.h"

namespace fluxfarm {
namespace {

void print_info(bool json) {
  const nlohmann::json info = {{"engine", engine_version()},
                               {"build", engine_build_id()},
                               {"compiler", compiler()},
                               {"build_options", build_options()},
                               {"instruction_set", instruction_set()},
                               {"embree", ray_library_version()},
                               {"protocol_version", kProtocolVersion},
                               {"max_samples_per_pass", kMaxSamplesPerPass},
                               {"integrators", integrator_names()},
                               {"threads", resolve_threads(0)}};
  if (json) {
    std::printf("%s\n", info.dump(2).c_str());
    return;
  }
  for (const auto& [name, value] : info.items()) {
    std::printf("%-22s %s\n", name.c_str(), value.is_string() ? value.get<std::string>().c_str() : value.dump().c_str());
  }
}

struct PlanOptions {
  SceneOptions scene;
  std::string integrator;  // "": as the scene says
  Goal goal;
  std::uint64_t seed = 0;
  int threads = 0;
  bool json = false;
};

void print_choice(const nlohmann::json& choice) {
  std::printf("chosen for: %s\n", choice["reason"].get<std::string>().c_str());
  for (const auto& method : choice["methods"]) {
    std::printf("%-22s ", method["method"].get<std::string>().c_str());
    if (method["tried"].get<bool>()) {
      std::printf("error %.2g with %.0f samples a pixel in about %.2g s\n", method["error"].get<double>(),
                  method["samples"].get<double>(), method["seconds"].get<double>());
    } else {
      std::printf("left out: %s\n", method["reason"].get<std::string>().c_str());
    }
  }
}

void print_plan(const PlanOptions& options) {
  const SceneDescription description = options.scene.read();
  const Scene scene(description, 0);
  const FilmDescription& film = scene.film();
  const Picture picture{{film.crop_x, film.crop_y, film.crop_width, film.crop_height},
                        options.seed,
                        settled(options.goal, description.samples_per_pixel)};
  const std::atomic<bool> never{false};
  const Method method =
      make_method(method_for(options.integrator, options.scene.scene), scene, picture, resolve_threads(options.threads), never);
  const nlohmann::json plan =
      nlohmann::json::parse(plan_json(scene, *method.integrator, method.choice ? &*method.choice : nullptr));
  if (options.json) {
    std::printf("%s\n", plan.dump(2).c_str());
    return;
  }
  std::printf("integrator: %s\n", plan["integrator"].get<std::string>().c_str());
  if (plan.contains("choice")) print_choice(plan["choice"]);
  for (const auto& part : plan["parts"]) {
    std::printf("%-22s %-3s  %s\n", part["part"].get<std::string>().c_str(), part["on"].get<bool>() ? "on" : "off",
                part["reason"].get<std::string>().c_str());
  }
}

struct WorkerOptions {
  int fd = -1, threads = 0;
  std::filesystem::path data;
  std::uint64_t memory_bytes = 0;
  bool require_sandbox = false;
};

void work(const WorkerOptions& options) {
  std::vector<std::string> missing = {"not asked for"};
  if (!options.data.empty()) {
    missing = enter_sandbox({{options.data / "scenes", options.data / "assets"}, {options.data / "jobs"}, options.memory_bytes});
  }
  if (options.require_sandbox && !missing.empty()) throw ResourceError("the sandbox is not whole, without: " + missing.front());
  run_worker(options.fd, resolve_threads(options.threads), missing);
}

}  // namespace

void add_info_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("info", "Versions, instruction sets, build options");
  const auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "As JSON");
  command->callback([json] { print_info(*json); });
}

void add_plan_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("plan", "What a scene contains and which parts of the engine it needs");
  const auto options = std::make_shared<PlanOptions>();
  options->scene.add_to(*command, true);
  command->add_flag("--json", options->json, "As JSON");
  add_method_option(*command, options->integrator);
  add_goal_options(*command, options->goal);
  command->add_option("--threads", options->threads, "Render threads of a pilot; default: all cores")->check(CLI::Range(1, 1024));
  command->add_option("--seed", options->seed, "Seed of the random numbers")->capture_default_str();
  command->callback([options] { print_plan(*options); });
}

void add_worker_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("worker", "Serve render requests on an inherited socket (used by the service)");
  const auto options = std::make_shared<WorkerOptions>();
  command->add_option("--fd", options->fd, "Number of the inherited socket")->required()->check(CLI::NonNegativeNumber);
  command->add_option("--threads", options->threads, "Render threads; default: all cores")->check(CLI::Range(1, 1024));
  command->add_option("--data", options->data, "The service's data folder: nothing else is read or written");
  command->add_option("--memory", options->memory_bytes, "Most bytes to take; 0: any");
  command->add_flag("--require-sandbox", options->require_sandbox, "Refuse to run where the kernel cannot hold that");
  command->callback([options] { work(*options); });
}

}  // namespace fluxfarm
