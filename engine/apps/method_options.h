// Options that choose a method and say when to stop, shared by the commands.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "film/goal.h"

namespace fluxfarm {

void add_method_option(CLI::App& command, std::string& integrator);
// At most one of them may be given.
void add_goal_options(CLI::App& command, Goal& goal);

}  // namespace fluxfarm
