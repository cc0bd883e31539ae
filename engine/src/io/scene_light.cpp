#include "io/scene_light.h"

#include <algorithm>

namespace fluxfarm {
namespace {

bool is_black(const PointEmitterDescription& point) { return point.intensity.is_black(); }
bool is_black(const SpotEmitterDescription& spot) { return spot.intensity.is_black(); }
bool is_black(const DirectionalEmitterDescription& light) { return light.irradiance.is_black(); }
bool is_black(const ConstantEmitterDescription& constant) { return constant.radiance.is_black(); }

bool is_black(const EnvmapEmitterDescription& map) {
  return std::all_of(map.image.pixels.begin(), map.image.pixels.end(), [](Rgb pixel) { return pixel.is_black(); });
}

}  // namespace

bool has_light(const SceneDescription& scene) {
  const bool shines = std::any_of(scene.shapes.begin(), scene.shapes.end(), [](const ShapeDescription& shape) {
    return shape.emitted_radiance && !shape.emitted_radiance->is_black();
  });
  return shines || std::any_of(scene.emitters.begin(), scene.emitters.end(), [](const EmitterDescription& emitter) {
           return !std::visit([](const auto& described) { return is_black(described); }, emitter);
         });
}

}  // namespace fluxfarm
