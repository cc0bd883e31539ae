// Independent random numbers of one particle of light, one photon or one probe of the audit, keyed by (seed, kind, index).
//
// Not quasi-Monte Carlo points: the audit's error comes from the squares of its summands, which holds for independent ones, and
// the ledger of photons is tested in the same way.
#pragma once

#include <cstdint>

#include "math/vec.h"
#include "sampling/hash.h"

namespace fluxfarm {

class KeyRandom {
 public:
  enum Kind : std::uint64_t { kParticle = 0x6c69676874, kProbe = 0x70726f6265, kPhoton = 0x70686f746f6e, kLabel = 0x6c6162656c };

  KeyRandom(std::uint64_t seed, Kind kind, std::uint64_t index) : key_(hash_words(seed, static_cast<std::uint64_t>(kind), index)) {}

  // In [0,1)^2.
  Vec2f next_2d() {
    const std::uint64_t bits = hash_words(key_, count_++);
    return {static_cast<float>(bits >> 40) * 0x1p-24f, static_cast<float>((bits >> 16) & 0xffffff) * 0x1p-24f};
  }
  float next_1d() { return next_2d().x; }

 private:
  std::uint64_t key_, count_ = 0;
};

}  // namespace fluxfarm
