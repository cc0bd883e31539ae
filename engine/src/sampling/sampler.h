// Random numbers of camera samples, keyed by (seed, pixel, sample index, dimension): cutting the image, the samples or the work
// differently cannot change them.
//
// Samples fall into kReplicates replicates: sample i belongs to replicate i mod kReplicates, and each replicate of each pixel
// has its own Owen scramble. The replicate means are therefore independent, and their spread gives an error that stays right
// for quasi-Monte Carlo points. Each dimension is a pair of Sobol dimensions with its own shuffle ("padding"), so that the two
// numbers of a pair are stratified together and pairs are unrelated.
//
// Numbers are drawn for many samples at once: the arithmetic is the same for each, and the compiler makes vectors of it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "math/vec.h"
#include "sampling/hash.h"
#include "sampling/owen_sobol.h"

namespace fluxfarm {

inline constexpr std::uint32_t kReplicates = 8;

// At most this many samples draw together.
inline constexpr std::size_t kMaxSamplerBatch = 64;

class SamplerBatch {
 public:
  void clear() { size_ = 0; }
  std::size_t size() const { return size_; }

  // Adds sample `index` of pixel (x, y).
  void add(std::uint64_t seed, int x, int y, std::uint32_t index) {
    const auto pixel = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32) | static_cast<std::uint32_t>(x);
    const std::uint64_t key = hash_words(seed, pixel, index % kReplicates);
    key_low_[size_] = static_cast<std::uint32_t>(key);
    key_high_[size_] = static_cast<std::uint32_t>(key >> 32);
    reversed_index_[size_++] = reverse_bits(index / kReplicates);
  }

  // Moves the sample at `from` down to `to`.
  void move(std::size_t from, std::size_t to) {
    key_low_[to] = key_low_[from];
    key_high_[to] = key_high_[from];
    reversed_index_[to] = reversed_index_[from];
  }
  void resize(std::size_t size) { size_ = size; }

  // u in [0,1)^2 of that dimension for each sample, in order.
  void draw_2d(std::uint32_t dimension, std::array<Vec2f, kMaxSamplerBatch>& u) const;
  // u in [0,1) of that dimension for one sample. A dimension is drawn either in one or in two numbers.
  float draw_1d(std::uint32_t dimension, std::size_t sample) const {
    const std::uint32_t shuffle = mix_bits_32(key_low_[sample] + dimension * 0x9e3779b9u);
    return owen_van_der_corput(reversed_index_[sample], shuffle, mix_bits_32(key_high_[sample] ^ shuffle));
  }

 private:
  std::size_t size_ = 0;
  std::array<std::uint32_t, kMaxSamplerBatch> key_low_, key_high_, reversed_index_;
};

}  // namespace fluxfarm
