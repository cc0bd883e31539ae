// How far a method gets with so many samples, from its trial, and how many a goal takes.
//
// The rules are fits to our scenes (engine/docs/decisions/0012): noise falls a little faster than 1 / samples; each level of an
// irradiance cache takes about twice the rays of the one before, and a quarter of its bias is left; the bias of photons falls as
// samples^(-2/3).
#pragma once

#include <cstdint>

#include "film/goal.h"
#include "integrators/plan/method_trial.h"

namespace fluxfarm {

inline constexpr double kMostForecast = 1 << 20;  // samples

// Mean over the pixels of the trial.
double mean_noise(const MethodTrial& trial);
// That of one sample of each pixel, as many of them will show it.
double settled_noise(const MethodTrial& trial);

// After `samples` of every pixel.
MethodForecast forecast_samples(const MethodTrial& trial, double samples);

// Until `goal`. A goal that is out of reach takes kMostForecast samples. What a goal in seconds leaves time for is counted in rays,
// at a rate that is the same everywhere.
MethodForecast forecast(const MethodTrial& trial, const Goal& goal);

// Whether the forecast is one of reaching the goal; always so for goals other than an error.
bool reaches(const MethodForecast& forecast, const Goal& goal);

}  // namespace fluxfarm
