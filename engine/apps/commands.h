// The subcommands of fluxfarm-engine. Each adds itself to the command line; its callback runs when it was chosen.
#pragma once

#include <CLI/CLI.hpp>

namespace fluxfarm {

void add_render_command(CLI::App& app);
void add_plan_command(CLI::App& app);
void add_info_command(CLI::App& app);
void add_bench_command(CLI::App& app);
void add_worker_command(CLI::App& app);

}  // namespace fluxfarm
