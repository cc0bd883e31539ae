// Which method renders a picture, and why: what "auto" decides by.
//
// A choice depends on counted work and on errors, never on a clock, so that a job gets the same method wherever it is rendered.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "film/goal.h"
#include "integrators/plan/method_trial.h"

namespace fluxfarm {

// A method with what is known of it. One without a trial was left out, for `reason`.
struct MethodCandidate {
  std::string method;
  std::string reason;
  std::optional<MethodTrial> trial;
  std::optional<MethodForecast> forecast;
};

struct MethodChoice {
  std::string method;
  std::string reason;  // in words
  Goal goal;
  std::vector<MethodCandidate> candidates;
  double seconds = 0;           // that the pilot took
  double expected_seconds = 0;  // with those, until the goal
};

// What a method costs a goal. An error goal: work until it, the geometric mean of what is foretold and of what it would be with
// twice the noise, as few samples seldom tell all of it; and where the goal is out of reach so many times more as the relMSE is too
// large. Else relMSE, times the work where samples are given.
double cost(const MethodForecast& forecast, const Goal& goal);

// Takes the cheapest candidate of those with a forecast, or the first one where none has: sets method and reason.
void choose_cheapest(MethodChoice& choice);

}  // namespace fluxfarm
