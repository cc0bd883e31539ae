#include "sampling/sampler.h"

#include "support/vector_clones.h"

namespace fluxfarm {
namespace {

// Plain arrays and no calls that are not inlined: the shape that compilers turn into vectors.
FLUXFARM_VECTOR_CLONES void draw(const std::uint32_t* __restrict key_low, const std::uint32_t* __restrict key_high,
                                 const std::uint32_t* __restrict reversed_index, std::uint32_t dimension, std::size_t size,
                                 float* __restrict x, float* __restrict y) {
  for (std::size_t i = 0; i < size; ++i) {
    const std::uint32_t shuffle = mix_bits_32(key_low[i] + dimension * 0x9e3779b9u);
    const std::uint32_t scramble = mix_bits_32(key_high[i] ^ shuffle);
    const Vec2f u = owen_sobol_2d(reversed_index[i], shuffle, scramble, scramble * 0x9e3779b9u + shuffle);
    x[i] = u.x;
    y[i] = u.y;
  }
}

}  // namespace

void SamplerBatch::draw_2d(std::uint32_t dimension, std::array<Vec2f, kMaxSamplerBatch>& u) const {
  std::array<float, kMaxSamplerBatch> x, y;
  draw(key_low_.data(), key_high_.data(), reversed_index_.data(), dimension, size_, x.data(), y.data());
  for (std::size_t i = 0; i < size_; ++i) u[i] = {x[i], y[i]};
}

}  // namespace fluxfarm
