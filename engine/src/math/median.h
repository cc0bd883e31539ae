// The median of a few numbers, without branches: values that are noise would mislead every one of them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace fluxfarm {

// Four numbers side by side, of which each has its own median: what one vector register holds.
using Lanes = std::array<float, 4>;

// In each lane the element of rank count / 2 (from 0) of the first `count` values, 1 <= count <= N.
template <std::size_t N>
Lanes median(std::array<Lanes, N> values, std::size_t count) {
  // The places that are left do not move it to another rank than that of the middle one.
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::size_t place = count;
  for (std::size_t below = count / 2; below < N / 2; ++below) values[place++] = {-kInfinity, -kInfinity, -kInfinity, -kInfinity};
  while (place < N) values[place++] = {kInfinity, kInfinity, kInfinity, kInfinity};
  // Odd-even transposition sort.
  for (std::size_t round = 0; round < N; ++round) {
    for (std::size_t i = round % 2; i + 1 < N; i += 2) {
      Lanes less, more;
      for (std::size_t lane = 0; lane < 4; ++lane) {
        less[lane] = std::min(values[i][lane], values[i + 1][lane]);
        more[lane] = std::max(values[i][lane], values[i + 1][lane]);
      }
      values[i] = less;
      values[i + 1] = more;
    }
  }
  return values[N / 2];
}

}  // namespace fluxfarm
