// What a few samples of a few tiles tell of a method: the figures by which methods are compared.
#pragma once

#include <vector>

namespace fluxfarm {

// What one tile that was tried has.
struct TileNoise {
  double share = 0;  // of relMSE by noise, a mean over its pixels
  int pixels = 0;
};

struct MethodTrial {
  double samples = 0;  // of each pixel of its tiles
  std::vector<TileNoise> noise;
  double bias = 0;  // share of relMSE by the method's bias, a mean over all pixels that were tried
  // Share of relMSE that light which those samples are not likely to have met leaves after one sample of each pixel.
  double unmet_noise = 0;
  // Rays, each counted as so many of path tracing as it takes the time of: for one sample of every pixel, and before the first.
  double work_per_sample = 0, work_ahead = 0;
  // Whether there are levels of a cache: the first takes `work_ahead`, each later one more. Else the work is done once.
  bool in_levels = false;
  // Measured, to tell seconds; no choice depends on it.
  double seconds_per_work = 0;
};

// What a picture by a method will take.
struct MethodForecast {
  double samples = 0;        // of a pixel, in the mean
  double error = 0;          // sqrt(relMSE), by noise and bias
  double work = 0;           // in rays of path tracing
  double work_in_doubt = 0;  // the same if there is twice the noise; of error goals
  double seconds = 0;
};

}  // namespace fluxfarm
