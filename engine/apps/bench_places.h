// What pixels see, one after the other as a picture would ask, and how fast something tells about these places.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <vector>

#include "accel/ray_queries.h"
#include "bench_tools.h"
#include "integrators/path/path_vertex.h"
#include "scene/scene.h"
#include "support/error.h"
#include "support/parallel.h"

namespace fluxfarm {

// About so many, on surfaces for which accepts(surface).
inline constexpr std::size_t kBenchPlaces = 200'000;
template <typename Accepts>
std::vector<PathVertex> seen_places(const Scene& scene, const Accepts& accepts) {
  std::vector<PathVertex> places;
  RayQueries queries(scene.accelerator());
  BsdfSpace space;
  const auto width = static_cast<std::size_t>(scene.film().width), height = static_cast<std::size_t>(scene.film().height);
  const std::size_t samples = kBenchPlaces / (width * height) + 1, step = std::max<std::size_t>(width * height / kBenchPlaces, 1);
  for (std::size_t pixel = 0; pixel < width * height; pixel += step) {
    const std::size_t column = pixel % width, row = pixel / width;
    for (std::size_t i = 0; i < samples; ++i) {
      const float shift = (static_cast<float>(i) + 0.5f) / static_cast<float>(samples);
      const Ray ray = scene.camera().ray(static_cast<float>(column) + shift, static_cast<float>(row) + 0.5f);
      Hit hit;
      queries.intersect({&ray, 1}, {&hit, 1}, false);
      if (hit.shape == Hit::kNone || !accepts(scene.surface(hit.shape))) continue;
      places.emplace_back(scene, ray, hit, space);
    }
  }
  if (places.empty()) throw Error("the camera sees no surface of the kind that is asked about: there is nothing to measure");
  return places;
}

// Answers a second. `make_estimate()` gives each thread its function of a place, an Rgb.
template <typename MakeEstimate>
double asked_per_second(const std::vector<PathVertex>& places, int threads, MakeEstimate&& make_estimate) {
  constexpr std::size_t kPart = 1000;  // places that a thread takes at once
  std::atomic<double> all{0};          // so that nothing is left out
  const BenchClock::time_point start = BenchClock::now();
  parallel_for((places.size() + kPart - 1) / kPart, threads, [&](std::size_t part, int) {
    prepare_render_thread();
    auto estimate = make_estimate();
    double sum = 0;
    for (std::size_t i = part * kPart; i < std::min(places.size(), (part + 1) * kPart); ++i) {
      sum += static_cast<double>(mean(estimate(places[i])));
    }
    all += sum;
  });
  const double seconds = seconds_since(start);
  if (!(all > 0)) throw Error("the estimates found no light: there is nothing to measure");
  return static_cast<double>(places.size()) / seconds;
}

}  // namespace fluxfarm
