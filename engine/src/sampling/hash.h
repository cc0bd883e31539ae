// Small integer hashes that key the random state. Not for security.
#pragma once

#include <cstdint>

namespace fluxfarm {

// Finaliser of splitmix64: a bijection of 64-bit words that mixes every input bit into every output bit.
constexpr std::uint64_t mix_bits(std::uint64_t v) {
  v ^= v >> 30;
  v *= 0xbf58476d1ce4e5b9ull;
  v ^= v >> 27;
  v *= 0x94d049bb133111ebull;
  v ^= v >> 31;
  return v;
}

// Hash of a sequence of words; different lengths and orders give unrelated values.
template <typename... Words>
constexpr std::uint64_t hash_words(std::uint64_t first, Words... rest) {
  std::uint64_t h = mix_bits(first + 0x9e3779b97f4a7c15ull);
  ((h = mix_bits(h ^ (static_cast<std::uint64_t>(rest) + 0x9e3779b97f4a7c15ull))), ...);
  return h;
}

}  // namespace fluxfarm
