// fluxfarm-engine: the engine alone, with no service.
#include <cstdio>
#include <new>

#include "commands.h"
#include "support/error.h"

namespace {

void run(CLI::App& app, int argc, char** argv) {
  app.require_subcommand(1);
  fluxfarm::add_render_command(app);
  fluxfarm::add_plan_command(app);
  fluxfarm::add_info_command(app);
  fluxfarm::add_bench_command(app);
  fluxfarm::add_worker_command(app);
  app.parse(argc, argv);
}

}  // namespace

// 0 done, 1 could not be done, 2 wrong command line or wrong input, 130 interrupted.
int main(int argc, char** argv) try {
  CLI::App app{"Fluxfarm's engine: renders scenes with an error estimate, alone or as a worker of the service."};
  try {
    run(app, argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const fluxfarm::SceneError& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 2;
  } catch (const fluxfarm::SettingError& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 2;
  } catch (const fluxfarm::CancelledError&) {
    std::fprintf(stderr, "interrupted: nothing was written\n");
    return 130;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "error: out of memory\n");
    return 1;
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "error: %s\n", error.what());
  return 1;
}
