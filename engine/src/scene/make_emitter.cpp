#include "scene/make_emitter.h"

#include "emitters/directional_emitter.h"
#include "emitters/envmap_emitter.h"
#include "emitters/spot_emitter.h"

namespace fluxfarm {
namespace {

constexpr float kRadians = kPi / 180;

std::unique_ptr<Emitter> make(const PointEmitterDescription& point, float) {
  return std::make_unique<PointEmitter>(point.position, point.intensity);
}

std::unique_ptr<Emitter> make(const SpotEmitterDescription& spot, float) {
  return std::make_unique<SpotEmitter>(spot.position, spot.axis, spot.intensity, spot.cutoff_angle_degrees * kRadians,
                                       spot.beam_width_degrees * kRadians);
}

std::unique_ptr<Emitter> make(const DirectionalEmitterDescription& light, float scene_radius) {
  return std::make_unique<DirectionalEmitter>(light.direction, light.irradiance, scene_radius);
}

std::unique_ptr<Emitter> make(const EnvmapEmitterDescription& map, float scene_radius) {
  return std::make_unique<EnvmapEmitter>(map.image, map.to_world, scene_radius);
}

std::unique_ptr<Emitter> make(const ConstantEmitterDescription&, float) { return nullptr; }

}  // namespace

std::unique_ptr<Emitter> make_emitter(const EmitterDescription& description, float scene_radius) {
  return std::visit([&](const auto& emitter) { return make(emitter, scene_radius); }, description);
}

}  // namespace fluxfarm
