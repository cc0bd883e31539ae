// Renders the first samples of a few tiles by one method and measures them.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "film/film.h"
#include "film/pixel_rect.h"
#include "integrators/integrator.h"
#include "integrators/plan/method_trial.h"
#include "worker/pilot_samples.h"

namespace fluxfarm {

// What all trials of a pilot share.
struct PilotTask {
  const Scene& scene;
  PixelRect crop;
  std::vector<PixelRect> tiles;  // of an error goal's grid over the crop
  std::uint64_t seed;
  int threads;
  const std::atomic<bool>& cancelled;

  double tried_pixels() const;
};

// Tiles of the crop, spread over it: one of 10, but at least 6 and at most 64, as far as there are so many.
std::vector<PixelRect> pilot_tiles(PixelRect crop);

class PilotTrial {
 public:
  PilotTrial(const PilotTask& task, const Integrator& integrator);

  // Takes samples up to `samples` of each pixel, in the passes of a picture.
  void advance(std::uint32_t samples);

  // Share of relMSE by noise, of each tile; from two samples on. A few bright samples do not count in full.
  std::vector<TileNoise> noise() const;
  // By the method's bias, mean over the pixels that were tried.
  double bias() const;
  // Share of relMSE, mean over the same, of one sample that seldom brings back `brightness` and else nothing, so that the mean is
  // the caustic layer.
  double caustic_square(double brightness) const;

  std::uint32_t samples() const { return done_; }                         // of each pixel
  double rays_ahead() const { return static_cast<double>(rays_ahead_); }  // of preparing the first pass
  double rays_per_sample() const;  // of every pixel of the crop, with what later passes were prepared by
  // That as many samples again take as there are, of a method that prepares no more ahead.
  double rays_to_double() const { return static_cast<double>(rays_of_passes_ + rays_of_tiles_); }
  double rays() const { return static_cast<double>(rays_ahead_ + rays_of_passes_ + rays_of_tiles_); }
  double seconds() const { return seconds_; }
  const std::vector<Film>& films() const { return films_; }  // one for each tile
  // What it prepared and, with `tiles`, rendered.
  PilotSamples take_samples(bool tiles) {
    if (!tiles) kept_.drop_tiles();
    return std::move(kept_);
  }

 private:
  const PilotTask& task_;
  const Integrator& integrator_;
  std::vector<Film> films_;
  std::uint32_t done_ = 0;
  std::uint64_t rays_ahead_ = 0, rays_of_passes_ = 0, rays_of_tiles_ = 0;
  double seconds_ = 0;
  PilotSamples kept_;
};

// How much of the noise is by indirect light and what is seen in mirrors and through glass, by the difference of the first half of
// the samples, in `half`, and the second.
double indirect_share(const std::vector<Film>& half, const std::vector<Film>& all);

}  // namespace fluxfarm
