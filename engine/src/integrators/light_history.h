// What happened to light on the part of its way that a path has traced back from the eye: decides the layer of what the path finds.
//
// An event is scattering by a continuous lobe (D), by a delta lobe (S) or in a medium; places where light passes as if nothing was
// there are none. The layers, by events counted from the eye (docs/theory.md): none or D alone, direct; D S ... S, caustic; D and
// anything else, indirect; S first, specular; a medium first, volume.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "film/light_layer.h"
#include "materials/bsdf.h"
#include "scene/scene.h"

namespace fluxfarm {

class LightHistory {
 public:
  // Of light that an emitter sends along the path's ray.
  LightLayer layer() const { return state_ == kUnscattered ? LightLayer::kDirect : static_cast<LightLayer>(state_); }
  // Of light that an emitter sends to the surface where the path is, to be scattered there by a continuous lobe.
  LightLayer layer_by_surface() const { return static_cast<LightLayer>(kNext[state_][kContinuous]); }
  // Of light that arrives at the surface after scattering by delta lobes alone, or by others, and is scattered there by a
  // continuous lobe.
  LightLayer layer_by_caustic() const { return static_cast<LightLayer>(kNext[kNext[state_][kContinuous]][kDelta]); }
  LightLayer layer_by_indirect() const { return static_cast<LightLayer>(kNext[kNext[state_][kContinuous]][kContinuous]); }
  // The same as layer_by_surface() in a medium.
  LightLayer layer_by_medium() const { return static_cast<LightLayer>(kNext[state_][kInMedium]); }

  void scatter_at_surface(const BsdfSample& sample) {
    state_ = kNext[state_][static_cast<std::size_t>(sample.delta) + static_cast<std::size_t>(sample.passes)];
  }
  void scatter_in_medium() { state_ = kNext[state_][kInMedium]; }

 private:
  // The layers, as LightLayer counts them, and one more.
  enum State : std::uint8_t { kDirect, kSpecular, kCaustic, kIndirect, kVolume, kUnscattered };
  enum Event { kContinuous, kDelta, kPass, kInMedium };
  // By state, then by event: a continuous lobe, a delta lobe, straight on as if the surface was not there, a medium.
  static constexpr std::array<std::array<State, 4>, 6> kNext = {{{kIndirect, kCaustic, kDirect, kIndirect},
                                                                 {kSpecular, kSpecular, kSpecular, kSpecular},
                                                                 {kIndirect, kCaustic, kCaustic, kIndirect},
                                                                 {kIndirect, kIndirect, kIndirect, kIndirect},
                                                                 {kVolume, kVolume, kVolume, kVolume},
                                                                 {kDirect, kSpecular, kUnscattered, kVolume}}};

  State state_ = kUnscattered;
};

// The layers that light in the scene can belong to.
inline LightLayers light_layers(const Census& census) {
  LightLayers layers;
  layers.insert(LightLayer::kDirect).insert(LightLayer::kIndirect);
  if (census.delta_lobes) layers.insert(LightLayer::kSpecular).insert(LightLayer::kCaustic);
  if (census.media > 0) layers.insert(LightLayer::kVolume);
  return layers;
}

}  // namespace fluxfarm
