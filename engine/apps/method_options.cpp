#include "method_options.h"

#include <algorithm>
#include <cctype>

namespace fluxfarm {

void add_method_option(CLI::App& command, std::string& integrator) {
  command.add_option(
      "--integrator", integrator,
      "Method: auto, path, photon, photon-progressive or irradiance-cache; default: as the scene says, of glTF auto");
}

std::string method_for(const std::string& integrator, const std::filesystem::path& scene) {
  std::string ending = scene.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const bool is_gltf = ending == ".glb" || ending == ".gltf";
  return integrator.empty() && is_gltf ? "auto" : integrator;
}

void add_goal_options(CLI::App& command, Goal& goal) {
  auto* spp = command.add_option("--spp", goal.spp, "Samples per pixel")->check(CLI::Range(1u, 1u << 24));
  auto* seconds = command.add_option("--seconds", goal.seconds, "Time budget in seconds")->check(CLI::PositiveNumber);
  auto* error = command.add_option("--rel-error", goal.rel_error, "Stop at this estimated relative error, sqrt(relMSE)")
                    ->check(CLI::PositiveNumber);
  spp->excludes(seconds)->excludes(error);
  seconds->excludes(error);
}

}  // namespace fluxfarm
