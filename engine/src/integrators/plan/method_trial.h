// What a few samples of a few tiles tell of a method: the figures by which methods are compared.
#pragma once

#include <string>
#include <vector>

namespace fluxfarm {

struct MethodTrial {
  std::string method;
  // Of each tile that was tried the share of relMSE by noise that kFirstRound samples of every pixel leave.
  std::vector<double> noise;
  // The same of the whole picture by light that the trial's samples are not likely to have met: a mean over the tiles.
  double unmet_noise = 0;
  // And by the method's bias, which falls as samples are added.
  double bias = 0;
  // Rays, each counted as so many of path tracing as it takes the time of: for one sample of every pixel, and before the first.
  double work_per_sample = 0, work_ahead = 0;
  // What each further level of a cache takes: the first `work_ahead`, each later one more. False: there are no levels.
  bool in_levels = false;
  // Measured, for forecasts in seconds; no choice depends on it.
  double seconds_per_work = 0;
};

// What a picture by a method will take.
struct MethodForecast {
  double samples = 0;  // of a pixel, in the mean
  double error = 0;    // sqrt(relMSE), by noise and bias
  double work = 0;     // in rays of path tracing
  double seconds = 0;
};

}  // namespace fluxfarm
