#include "worker/build_id.h"

#include "accel/ray_accelerator.h"
#include "support/build_info.h"

namespace fluxfarm {

std::string engine_build_id() { return engine_build() + ", Embree " + ray_library_version(); }

}  // namespace fluxfarm
