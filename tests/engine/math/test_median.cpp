// The median of few numbers, against sorting them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "math/median.h"

namespace fluxfarm {
namespace {

TEST(Median, IsWhatSortingFindsInEachLane) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> any(-9, 9);  // with repetitions
  for (int trial = 0; trial < 2000; ++trial) {
    const std::size_t count = 1 + static_cast<std::size_t>(trial) % 9;
    std::array<Lanes, 9> values = {};
    std::array<std::vector<float>, 4> sorted;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t lane = 0; lane < 4; ++lane) {
        values[i][lane] = static_cast<float>(any(random));
        sorted[lane].push_back(values[i][lane]);
      }
    }
    const Lanes found = median(values, count);
    for (std::size_t lane = 0; lane < 4; ++lane) {
      std::ranges::sort(sorted[lane]);
      EXPECT_EQ(found[lane], sorted[lane][count / 2]) << count << " values";
    }
  }
}

}  // namespace
}  // namespace fluxfarm
