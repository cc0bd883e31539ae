// The error that light makes which path tracing did not find, as far as an estimate from the side of the light tells.
//
// A cell misses what no path can find, and, where the side of the light clearly has more, the difference. If light of mean m is
// missing from a cell, its share of relMSE is x^2 / ((c + x)^2 + 1e-2) in a pixel of value c that misses x, at most
// x / (2 (c + sqrt(c^2 + 1e-2))) and never above 1. The bound lays m out where that costs most: on the darkest pixels first, on
// each until its share is 1 (docs/theory.md). The error is the root of the mean of that over the picture: an upper bound, like that
// of the noise.
//
// In and through smooth surfaces the audit sees nothing. There, light that was scattered sharply is taken to be the part that it is
// in the whole scene: it makes a noise that is known (LightAudit::rare_brightness), and what the samples do not show of it they
// have not met.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "film/film.h"
#include "film/light_audit.h"

namespace fluxfarm {

struct UnseenError {
  double error = 0;                     // bound of sqrt(relMSE) by missing light; 0: nothing was found missing
  double unreachable_error = 0;         // the part of it that no sample can mend, or only far too many
  double rare_error = 0;                // the part of it by light behind smooth surfaces that paths may find
  double energy = 0;                    // share of the picture's light that is missing, as estimated
  std::vector<std::uint32_t> doubtful;  // cells where more samples may find what is missing, rising
};

// At look `number` (1, 2, ...). `audit` is one of the film's crop, and was possible.
UnseenError unseen_error(const Film& film, const LightAudit& audit, int number);

// Why a picture misses that goal (sqrt(relMSE)), and what its owner can do. Something must be missing.
std::string unseen_warning(const UnseenError& unseen, double goal);
// Of a scene that cannot be audited: beside a claim, and why there is none where no path may find the light.
std::string unaudited_warning();
std::string unclaimed_warning();

}  // namespace fluxfarm
