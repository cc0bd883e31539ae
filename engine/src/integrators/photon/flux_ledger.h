// The books of the light that photons carry: where all that was emitted has gone.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace fluxfarm {

// All in W, mean over R, G and B. Emitted = absorbed + escaped + cut + ended - regained, whatever the random numbers; in the mean
// roulette gives to the survivors what it takes from the others, so that ended = regained.
struct FluxLedger {
  static constexpr std::size_t kBounces = 32;

  double emitted = 0;
  double left_out = 0;  // never emitted: the part of the emitters' power that a projection map does without
  double absorbed = 0;  // by surfaces and media: what arrived less what sampling sent on
  double escaped = 0;   // out of the scene
  double cut = 0;       // by the limit of bounces, or because what comes is not to be stored
  double ended = 0;     // by roulette
  double regained = 0;  // by survivors of roulette
  // What arrives at the first, second ... surface or collision on the way; the last counts all that come after it, too.
  std::array<double, kBounces> arrived{};

  // `bounce` counts from 0.
  void arrive(std::size_t bounce, double flux) { arrived[std::min(bounce, kBounces - 1)] += flux; }

  void add(const FluxLedger& other) {
    emitted += other.emitted;
    left_out += other.left_out;
    absorbed += other.absorbed;
    escaped += other.escaped;
    cut += other.cut;
    ended += other.ended;
    regained += other.regained;
    for (std::size_t i = 0; i < kBounces; ++i) arrived[i] += other.arrived[i];
  }
};

}  // namespace fluxfarm
