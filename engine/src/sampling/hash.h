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

// A bijection of 32-bit words of the same kind: C. Wellons' "lowbias32", found by search.
constexpr std::uint32_t mix_bits_32(std::uint32_t v) {
  v ^= v >> 16;
  v *= 0x21f0aaadu;
  v ^= v >> 15;
  v *= 0x735a2d97u;
  return v ^ (v >> 15);
}

// Hash of a sequence of words; different lengths and orders give unrelated values.
template <typename... Words>
constexpr std::uint64_t hash_words(std::uint64_t first, Words... rest) {
  std::uint64_t h = mix_bits(first + 0x9e3779b97f4a7c15ull);
  ((h = mix_bits(h ^ (static_cast<std::uint64_t>(rest) + 0x9e3779b97f4a7c15ull))), ...);
  return h;
}

}  // namespace fluxfarm
