// How far a method gets with so many samples, from its trial, and how many a goal takes.
//
// The rules are fits to our scenes (engine/docs/decisions/0012): noise falls a little faster than 1 / samples, as samples are
// stratified; each level of an irradiance cache takes about twice the rays of the one before and a quarter of its bias is left.
#pragma once

#include "film/goal.h"
#include "integrators/plan/method_trial.h"

namespace fluxfarm {

// After `samples` of every pixel.
MethodForecast forecast_samples(const MethodTrial& trial, double samples);

// Until `goal`; of a goal in seconds, what is reached then. A goal that is out of reach takes kMostForecast samples.
MethodForecast forecast(const MethodTrial& trial, const Goal& goal);

inline constexpr double kMostForecast = 1 << 20;

}  // namespace fluxfarm
