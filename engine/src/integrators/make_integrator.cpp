#include "integrators/integrator.h"
#include "integrators/path/path_integrator.h"
#include "support/error.h"

namespace fluxfarm {

std::unique_ptr<Integrator> make_integrator(const std::string& name, const Scene& scene) {
  const std::string& wanted = name.empty() ? scene.method().integrator : name;
  if (wanted != "path" && wanted != "auto") {
    throw SettingError("integrator = \"" + wanted + "\", expected path or auto");
  }
  auto integrator = std::make_unique<PathIntegrator>();
  integrator->prepare(scene);
  return integrator;
}

}  // namespace fluxfarm
