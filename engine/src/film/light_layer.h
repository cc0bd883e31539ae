// The layers into which beauty is split by what light did on its way; they add up to beauty. Who decides: an integrator.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace fluxfarm {

enum class LightLayer : std::uint8_t { kDirect, kSpecular, kCaustic, kIndirect, kVolume };

inline constexpr std::size_t kLightLayers = 5;
// Of the layers' channels in an image, before ".R", ".G", ".B".
inline constexpr std::array<const char*, kLightLayers> kLightLayerNames = {"direct", "specular", "caustic", "indirect", "volume"};

// Those layers that a scene can have: no others are summed, stored or written.
class LightLayers {
 public:
  LightLayers() = default;
  // `bits`: those of `bits()`; any beyond are ignored.
  explicit LightLayers(std::uint32_t bits) : bits_(bits & ((1u << kLightLayers) - 1)) {}

  LightLayers& insert(LightLayer layer) {
    bits_ |= 1u << static_cast<std::uint32_t>(layer);
    return *this;
  }
  // Rising: the order in which sums hold them.
  std::vector<LightLayer> list() const {
    std::vector<LightLayer> layers;
    for (std::uint32_t layer = 0; layer < kLightLayers; ++layer) {
      if ((bits_ >> layer & 1u) != 0) layers.push_back(static_cast<LightLayer>(layer));
    }
    return layers;
  }
  std::size_t size() const { return static_cast<std::size_t>(std::popcount(bits_)); }
  // Bit k is set if the k-th layer is in it.
  std::uint32_t bits() const { return bits_; }
  bool operator==(const LightLayers&) const = default;

 private:
  std::uint32_t bits_ = 0;
};

}  // namespace fluxfarm
