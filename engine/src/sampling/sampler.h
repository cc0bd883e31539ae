// Random numbers of one camera sample, keyed by (seed, pixel, sample index, dimension): cutting the image, the samples or the
// work differently cannot change them.
//
// Samples fall into kReplicates replicates: sample i belongs to replicate i mod kReplicates, and each replicate of each pixel
// has its own Owen scramble. The replicate means are therefore independent, and their spread gives an error that stays right
// for quasi-Monte Carlo points. Successive draws take successive pairs of Sobol dimensions with independent shuffles
// ("padding"), so that each pair is stratified and pairs are unrelated.
#pragma once

#include <cstdint>

#include "sampling/hash.h"
#include "sampling/owen_sobol.h"

namespace fluxfarm {

inline constexpr std::uint32_t kReplicates = 8;

class Sampler {
 public:
  explicit Sampler(std::uint64_t seed) : seed_(seed) {}

  // Begins sample `index` of pixel (x, y); the next draw is dimension 0.
  void start_pixel_sample(int x, int y, std::uint32_t index) {
    const auto pixel = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32) | static_cast<std::uint32_t>(x);
    key_ = hash_words(seed_, pixel, index % kReplicates);
    index_ = index / kReplicates;
  }

  // u in [0, 1).
  float next_1d() { return owen_van_der_corput(index_, next_key()); }
  // u in [0, 1)^2.
  Vec2f next_2d() { return owen_sobol_2d(index_, next_key()); }

 private:
  std::uint64_t next_key() { return mix_bits(key_ += 0x9e3779b97f4a7c15ull); }

  std::uint64_t seed_;
  std::uint64_t key_ = 0;
  std::uint32_t index_ = 0;
};

}  // namespace fluxfarm
