// Options that choose a method and say when to stop, shared by the commands.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "film/goal.h"

namespace fluxfarm {

void add_method_option(CLI::App& command, std::string& integrator);
// What was asked for; "" is the scene's own. A glTF file has no word for one, so it gets "auto".
std::string method_for(const std::string& integrator, const std::filesystem::path& scene);
// At most one of them may be given.
void add_goal_options(CLI::App& command, Goal& goal);

}  // namespace fluxfarm
