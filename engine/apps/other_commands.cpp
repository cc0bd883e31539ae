// fluxfarm-engine plan, info, worker: the short commands.
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "accel/ray_accelerator.h"
#include "commands.h"
#include "film/pass_schedule.h"
#include "scene_options.h"
#include "support/build_info.h"
#include "worker/build_id.h"
#include "worker/messages.h"
#include "worker/plan.h"
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

void print_plan(const SceneOptions& options, const std::string& integrator, bool json) {
  const Scene scene(options.read(), 0);
  const nlohmann::json plan = nlohmann::json::parse(plan_json(scene, *make_integrator(integrator, scene)));
  if (json) {
    std::printf("%s\n", plan.dump(2).c_str());
    return;
  }
  std::printf("integrator: %s\n", plan["integrator"].get<std::string>().c_str());
  for (const auto& part : plan["parts"]) {
    std::printf("%-22s %-3s  %s\n", part["part"].get<std::string>().c_str(), part["on"].get<bool>() ? "on" : "off",
                part["reason"].get<std::string>().c_str());
  }
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
  const auto options = std::make_shared<SceneOptions>();
  const auto json = std::make_shared<bool>(false);
  options->add_to(*command, false);
  command->add_flag("--json", *json, "As JSON");
  const auto integrator = std::make_shared<std::string>();
  command->add_option("--integrator", *integrator,
                      "Method: auto, path, photon, photon-progressive or irradiance-cache; default: as the scene says");
  command->callback([options, integrator, json] { print_plan(*options, *integrator, *json); });
}

void add_worker_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("worker", "Serve render requests on an inherited socket (used by the service)");
  const auto fd = std::make_shared<int>(-1);
  const auto threads = std::make_shared<int>(0);
  command->add_option("--fd", *fd, "Number of the inherited socket")->required()->check(CLI::NonNegativeNumber);
  command->add_option("--threads", *threads, "Render threads; default: all cores")->check(CLI::Range(1, 1024));
  command->callback([fd, threads] { run_worker(*fd, resolve_threads(*threads)); });
}

}  // namespace fluxfarm
