#include "integrators/integrator.h"
#include "integrators/path/path_integrator.h"
#include "integrators/path/volume_path_integrator.h"
#include "support/error.h"

namespace fluxfarm {

std::unique_ptr<Integrator> make_integrator(const std::string& name, const Scene& scene) {
  const std::string& wanted = name.empty() ? scene.method().integrator : name;
  if (wanted != "path" && wanted != "auto") {
    throw SettingError("integrator = \"" + wanted + "\", expected path or auto");
  }
  const Census& census = scene.census();
  std::unique_ptr<Integrator> integrator;
  if (census.media > 0 || census.null_boundaries) {
    integrator = std::make_unique<VolumePathIntegrator>();
  } else {
    integrator = std::make_unique<PathIntegrator>();
  }
  integrator->prepare(scene);
  return integrator;
}

}  // namespace fluxfarm
