#include "integrators/integrator.h"
#include "integrators/irradiance/irradiance_cache_integrator.h"
#include "integrators/path/path_integrator.h"
#include "integrators/path/volume_path_integrator.h"
#include "integrators/photon/photon_integrator.h"
#include "integrators/photon/photon_progressive_integrator.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

std::unique_ptr<Integrator> unprepared(const std::string& name, const Census& census) {
  if (name == "irradiance-cache") return std::make_unique<IrradianceCacheIntegrator>();
  if (name == "photon") return std::make_unique<PhotonIntegrator>();
  if (name == "photon-progressive") return std::make_unique<PhotonProgressiveIntegrator>();
  if (name != "path") {
    throw SettingError("integrator = \"" + name + "\", expected auto, path, photon, photon-progressive or irradiance-cache");
  }
  if (census.media > 0 || census.null_boundaries) return std::make_unique<VolumePathIntegrator>();
  return std::make_unique<PathIntegrator>();
}

}  // namespace

std::shared_ptr<const PreparedPass> Integrator::prepare_pass(std::uint64_t, SampleRange, int, const std::atomic<bool>&) const {
  return nullptr;
}

const std::vector<std::string>& integrator_names() {
  static const std::vector<std::string> names{"path", "photon", "photon-progressive", "irradiance-cache"};
  return names;
}

std::unique_ptr<Integrator> make_integrator(const std::string& name, const Scene& scene) {
  std::unique_ptr<Integrator> integrator = unprepared(name.empty() ? scene.method().integrator : name, scene.census());
  integrator->prepare(scene);
  return integrator;
}

}  // namespace fluxfarm
