// Camera samples that advance together: those of a block of neighbouring pixels, so that packets of rays are full even where a pass
// takes one sample of each pixel.
//
// Blocks lie at multiples of their size in the frame, and all of a block's samples go together whatever part of it a tile needs:
// how rays share packets must depend on neither tile nor crop (docs/decisions/0002).
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "film/pixel_rect.h"
#include "integrators/integrator.h"
#include "sampling/sampler.h"

namespace fluxfarm {

// Paths that advance together.
inline constexpr std::size_t kMaxPaths = kMaxSamplerBatch;

// Pixels of a block; powers of two.
struct BlockSize {
  int width = 1, height = 1;
};

// The largest block, nearly square, of which a pass of so many samples a pixel has at most kMaxPaths in all.
constexpr BlockSize block_size(std::size_t samples_per_pixel) {
  const std::size_t pixels = std::bit_floor(kMaxPaths / std::min(samples_per_pixel, kMaxPaths));
  const int bits = std::countr_zero(pixels);
  return {1 << ((bits + 1) / 2), 1 << (bits / 2)};
}

// Calls visit(pixels) for each block that has pixels in `rect`, row by row: the part of the block inside `frame`, which contains
// `rect`.
template <typename Visit>
void for_each_block(PixelRect rect, PixelRect frame, BlockSize size, const Visit& visit) {
  for (int y = rect.y / size.height * size.height; y < rect.y + rect.height; y += size.height) {
    for (int x = rect.x / size.width * size.width; x < rect.x + rect.width; x += size.width) {
      visit(PixelRect{x, y, std::min(size.width, frame.width - x), std::min(size.height, frame.height - y)});
    }
  }
}

// Calls trace(samples, results) for each block of a batch, in order; pixels with more than kMaxPaths samples come in pieces.
// Each pixel's samples stand together and are equally many.
template <typename Trace>
void for_each_group(std::span<const CameraSample> samples, std::span<SampleResult> results, const Trace& trace) {
  std::size_t per_pixel = 0;
  while (per_pixel < samples.size() && samples[per_pixel].x == samples[0].x && samples[per_pixel].y == samples[0].y) ++per_pixel;
  const BlockSize size = block_size(per_pixel);
  for (std::size_t begin = 0; begin < samples.size();) {
    std::size_t end = begin + 1;
    while (end < samples.size() && end - begin < kMaxPaths && samples[end].x / size.width == samples[begin].x / size.width &&
           samples[end].y / size.height == samples[begin].y / size.height) {
      ++end;
    }
    trace(samples.subspan(begin, end - begin), results.subspan(begin, end - begin));
    begin = end;
  }
}

}  // namespace fluxfarm
