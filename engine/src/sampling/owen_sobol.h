// Owen-scrambled Sobol points in one and two dimensions, computed from the index alone.
//
// [Burley20] B. Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020: scrambling and shuffling by a hash that lets
//            each bit depend on the bits above it only.
// The hash is N. Vegdahl's refinement of the Laine-Karras permutation ("Building a Better LK Hash", 2021).
// The second Sobol dimension's matrix is Pascal's triangle modulo 2, so by Lucas' theorem digit j of the point is the xor of
// the index bits k whose position contains j bitwise: a superset sum over five-bit positions, five shifts in all.
#pragma once

#include <cstdint>

#include "math/vec.h"

namespace fluxfarm {

constexpr std::uint32_t reverse_bits(std::uint32_t v) {
  v = (v >> 16) | (v << 16);
  v = ((v >> 8) & 0x00ff00ffu) | ((v & 0x00ff00ffu) << 8);
  v = ((v >> 4) & 0x0f0f0f0fu) | ((v & 0x0f0f0f0fu) << 4);
  v = ((v >> 2) & 0x33333333u) | ((v & 0x33333333u) << 2);
  return ((v >> 1) & 0x55555555u) | ((v & 0x55555555u) << 1);
}

// Permutation in which each bit depends on the bits below it and on `seed`. Between two bit reversals it is Owen's nested uniform
// scrambling of a binary fraction; of an index, a shuffle that keeps aligned blocks of 2^k together.    [Burley20, section 3]
constexpr std::uint32_t laine_karras_permutation(std::uint32_t v, std::uint32_t seed) {
  v ^= v * 0x3d20adeau;
  v += seed;
  v *= (seed >> 16) | 1;
  v ^= v * 0x05526c56u;
  v ^= v * 0x53a22864u;
  return v;
}

// Digits of the second Sobol dimension at `index`, least significant bit first (bit j is the digit of 2^-(j+1)).
constexpr std::uint32_t sobol_second_digits(std::uint32_t index) {
  std::uint32_t v = index;
  v ^= (v >> 1) & 0x55555555u;
  v ^= (v >> 2) & 0x33333333u;
  v ^= (v >> 4) & 0x0f0f0f0fu;
  v ^= (v >> 8) & 0x00ff00ffu;
  v ^= (v >> 16) & 0x0000ffffu;
  return v;
}

// The 24 leading bits of a binary fraction as a float in [0, 1).
constexpr float to_unit_float(std::uint32_t fraction) {
  return static_cast<float>(static_cast<std::int32_t>(fraction >> 8)) * 0x1p-24f;
}

// The two points below take their index with its bits reversed, as one index serves many dimensions; the seeds pick the shuffle of
// the index and the scramble of each coordinate.

// Point of an Owen-scrambled van der Corput sequence.
constexpr float owen_van_der_corput(std::uint32_t reversed_index, std::uint32_t shuffle, std::uint32_t scramble) {
  const std::uint32_t index = reverse_bits(laine_karras_permutation(reversed_index, shuffle));
  return to_unit_float(reverse_bits(laine_karras_permutation(index, scramble)));
}

// Point of an Owen-scrambled two-dimensional Sobol sequence, a (0,2)-sequence.
constexpr Vec2f owen_sobol_2d(std::uint32_t reversed_index, std::uint32_t shuffle, std::uint32_t scramble_x,
                              std::uint32_t scramble_y) {
  const std::uint32_t index = reverse_bits(laine_karras_permutation(reversed_index, shuffle));
  return {to_unit_float(reverse_bits(laine_karras_permutation(index, scramble_x))),
          to_unit_float(reverse_bits(laine_karras_permutation(sobol_second_digits(index), scramble_y)))};
}

}  // namespace fluxfarm
