// Where on its emitter each photon starts, and in which direction: points that fill both squares evenly, so that the light before
// its first surface falls with less noise than independent photons would bring.
//
// Owen-scrambled Sobol points (sampling/owen_sobol.h) in photon order, one sequence for the place and one for the direction. Of
// each emitter's photons, which stand together in that order, the points fill the squares, too. Different seeds are independent.
#pragma once

#include <cstdint>

#include "math/vec.h"
#include "sampling/hash.h"
#include "sampling/owen_sobol.h"

namespace fluxfarm {

class EmissionSequence {
 public:
  explicit EmissionSequence(std::uint64_t seed) : seed_(seed) {}

  struct Point {
    Vec2f place, direction;  // in [0,1)^2
  };
  // Of photon `index`. Each 2^32 photons have scrambles of their own.
  Point at(std::uint64_t index) const {
    const std::uint32_t reversed = reverse_bits(static_cast<std::uint32_t>(index));
    return {point(reversed, hash_words(seed_, index >> 32, 0)), point(reversed, hash_words(seed_, index >> 32, 1))};
  }

 private:
  static Vec2f point(std::uint32_t reversed_index, std::uint64_t key) {
    const auto shuffle = static_cast<std::uint32_t>(key);
    const std::uint64_t scrambles = mix_bits(key);
    return owen_sobol_2d(reversed_index, shuffle, static_cast<std::uint32_t>(scrambles),
                         static_cast<std::uint32_t>(scrambles >> 32));
  }

  std::uint64_t seed_;
};

}  // namespace fluxfarm
