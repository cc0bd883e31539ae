// Blocks of pixels whose rays share packets: full, complete, and the same wherever a tile lies.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "integrators/pixel_blocks.h"

namespace fluxfarm {
namespace {

constexpr PixelRect kFrame{0, 0, 37, 22};

std::set<std::pair<int, int>> pixels_of(PixelRect rect) {
  std::set<std::pair<int, int>> pixels;
  for (int y = rect.y; y < rect.y + rect.height; ++y) {
    for (int x = rect.x; x < rect.x + rect.width; ++x) pixels.emplace(x, y);
  }
  return pixels;
}

std::vector<PixelRect> blocks_of(PixelRect rect, BlockSize size) {
  std::vector<PixelRect> blocks;
  for_each_block(rect, kFrame, size, [&](PixelRect block) { blocks.push_back(block); });
  return blocks;
}

TEST(PixelBlocks, HoldAsManySamplesAsAdvanceTogether) {
  for (std::size_t samples = 1; samples <= 2 * kMaxPaths; ++samples) {
    const BlockSize size = block_size(samples);
    const std::size_t paths = samples * size.width * size.height;
    EXPECT_TRUE(paths <= kMaxPaths || size.width * size.height == 1) << samples;
    EXPECT_GT(2 * paths, kMaxPaths) << samples;
    EXPECT_TRUE(size.width == size.height || size.width == 2 * size.height) << samples;
  }
}

TEST(PixelBlocks, OfATileAreThoseOfTheFrame) {
  for (const std::size_t samples : {1, 2, 4, 8, 16, 32, 64}) {
    const BlockSize size = block_size(samples);
    const std::vector<PixelRect> all = blocks_of(kFrame, size);
    for (const PixelRect tile : {PixelRect{0, 0, 16, 16}, {3, 5, 11, 7}, {36, 21, 1, 1}}) {
      std::set<std::pair<int, int>> covered;
      for (const PixelRect& block : blocks_of(tile, size)) {
        EXPECT_EQ(std::count(all.begin(), all.end(), block), 1);
        covered.merge(pixels_of(block));
      }
      for (const auto& pixel : pixels_of(tile)) EXPECT_TRUE(covered.contains(pixel));
    }
  }
}

TEST(PixelBlocks, ABatchIsCutBetweenBlocks) {
  for (const std::uint32_t per_pixel : {1u, 3u, 8u, 64u, 100u}) {
    const std::vector<PixelRect> blocks = blocks_of(kFrame, block_size(per_pixel));
    std::vector<CameraSample> samples;
    for (const PixelRect& block : blocks) {
      for (const auto& [x, y] : pixels_of(block)) {
        for (std::uint32_t i = 0; i < per_pixel; ++i) samples.push_back({x, y, i});
      }
    }
    std::vector<SampleResult> results(samples.size());
    std::size_t groups = 0, traced = 0;
    for_each_group(samples, results, [&](std::span<const CameraSample> group, std::span<SampleResult> out) {
      ++groups;
      EXPECT_LE(group.size(), kMaxPaths);
      EXPECT_EQ(out.data() - results.data(), static_cast<std::ptrdiff_t>(traced));
      traced += group.size();
    });
    EXPECT_EQ(traced, samples.size());
    EXPECT_EQ(groups, per_pixel > kMaxPaths ? 2 * blocks.size() : blocks.size());
  }
}

}  // namespace
}  // namespace fluxfarm
