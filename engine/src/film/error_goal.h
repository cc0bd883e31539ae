// A goal of relative error, decided from the sums alone: which tiles take more samples, and when the picture is done.
//
// Samples are taken in rounds. The first takes kFirstRound samples of every pixel; each later one doubles those of some tiles.
// After a round comes one look:
// - The picture is done when the upper bound of its error (film/error_bound.h) is at or below the goal.
// - Otherwise tiles are open in which a sample takes off most of the error, so that their samples end in proportion to their
//   standard deviations: the fewest in all for the picture's error. Where few cells carry the error of a neighbourhood of 3 x 3
//   tiles, its variance per sample stands in for the tile's own if that is smaller: rare events strike neighbours alike, and the
//   tile may not have seen its own yet.
// - Of the open tiles those with the fewest samples make up the next round.
// - Light that an audit finds and the paths do not (film/unseen_error.h) counts like noise: cells in doubt stay open for a while,
//   and what no sample can mend is taken off the goal, or, where little would be left of that, ends as a goal that is not claimed.
// - The bias of the method (film/bias_error.h) is taken off the goal, too; where noise is low enough and bias is not, the tiles
// with most
//   of it go on.
// Every tile's decision is a function of the sums after a whole round, so it depends on no order, machine or clock.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "film/film.h"
#include "film/light_audit.h"
#include "film/pixel_rect.h"

namespace fluxfarm {

// Side of the tiles of a picture with an error goal, in pixels: part of what makes its pixels reproducible.
inline constexpr int kErrorTile = 32;
// Two samples in each replicate: with fewer, their spread says too little.
inline constexpr std::uint32_t kFirstRound = 16;

// Beyond so many samples a pixel no tile stays open because the audit doubts it, or for the method's bias (a choice): neither is
// worth a wait without an end.
inline constexpr std::uint32_t kMostForDoubt = 4096;

struct ErrorGoal {
  double rel_error = 0;                      // sqrt(relMSE)
  std::uint32_t most_samples = 0xffffffffu;  // per pixel
};

// Samples that certain tiles take, counted in rows over the crop of the film.
struct Round {
  SampleRange samples;
  std::vector<std::uint32_t> tiles;  // rising
};

Round first_round(const ErrorGoal& goal, PixelRect crop);

struct ErrorLook {
  // Of sqrt(relMSE), by noise with 95 % confidence over all looks, by the method's bias and by light that an audit missed; infinite
  // below two samples.
  double bound = 0;
  std::optional<Round> next;     // nothing: done, or no tile may take more samples
  double samples = 0;            // camera samples of the whole picture when it will be done, as far as can be told
  std::optional<double> unseen;  // of the bound the part by missing light; empty: not audited
  // At the end: why there is no claim, if missing light is the reason, or that the claim rests on noise alone; else "".
  std::string warning;
};

// The decision after round `number` (1, 2, ...).
// Without an `audit` light that was never sampled goes unnoticed, and no warning says so.
// `bias_falls`: whether more samples lessen the bias of the film's method, if it has one.
ErrorLook look_at(const Film& film, const ErrorGoal& goal, int number, const LightAudit* audit = nullptr, bool bias_falls = true);

}  // namespace fluxfarm
