// What the tests of irradiance caching share: places that a camera sees, the indirect irradiance that paths find there, and how far
// caches are from it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "integrators/irradiance/cached_irradiance.h"
#include "integrators/irradiance/hemisphere_sampler.h"
#include "integrators/irradiance/overture.h"
#include "sampling/hash.h"
#include "support/scene_builder.h"

namespace fluxfarm::testing {

// Where the paths through the middles of side x side parts of the film come to a diffuse surface, straight or by way of mirrors.
inline std::vector<GatherPlace> seen_places(const Scene& scene, int side) {
  std::vector<GatherPlace> places;
  RayQueries queries(scene.accelerator());
  const FilmDescription& film = scene.film();
  const int max_depth = scene.method().max_depth < 0 ? std::numeric_limits<int>::max() : scene.method().max_depth;
  for (int i = 0; i < side * side; ++i) {
    const auto middle = [side](int index, int pixels) {
      return (static_cast<float>(index) + 0.5f) * static_cast<float>(pixels) / static_cast<float>(side);
    };
    Ray ray = scene.camera().ray(middle(i % side, film.width), middle(i / side, film.height));
    float length = 0;
    for (int depth = 0; depth < 4; ++depth) {
      Hit hit;
      queries.intersect({&ray, 1}, {&hit, 1}, false);
      if (hit.shape == Hit::kNone) break;
      BsdfSpace space;
      const PathVertex vertex(scene, ray, hit, space);
      length += hit.t;
      if (takes_irradiance(*vertex.surface)) {
        if (vertex.wo.z > 0 && !vertex.bsdf->albedo(vertex.wo).is_black()) {
          places.push_back({vertex.point.position, vertex.frame, vertex.origin_towards(vertex.frame.n), depth,
                            receiving_place(vertex, max_depth - depth).room, scene.camera().pixel_angle() * length});
        }
        break;
      }
      const auto scatter = vertex.bsdf->sample(vertex.wo, 0.5f, {0.5f, 0.5f});
      if (!scatter || !scatter->delta) break;
      const Vec3f direction = vertex.frame.to_world(scatter->wi);
      ray = {vertex.origin_towards(direction), direction};
    }
  }
  return places;
}

// Indirect irradiance (green) by paths, and the variance of it.
struct Gathered {
  double irradiance = 0, variance = 0;
  double direct = 0;  // what comes straight from emitters that are points
};

inline double direct_irradiance(const Scene& scene, const GatherPlace& place) {
  const auto choice = scene.emitters().sample({place.position, place.frame.n, false}, 0.5f);
  if (!choice) return 0;
  const auto light = choice->emitter->sample(place.position, {0.5f, 0.5f});
  if (!light) return 0;
  const auto shadow = shadow_ray(place.origin, *light);
  if (!shadow || scene.accelerator().occluded(*shadow)) return 0;
  return static_cast<double>(light->weight.g * std::max(dot(light->wi, place.frame.n), 0.0f) / choice->probability);
}

inline std::vector<Gathered> gathered(const Scene& scene, const std::vector<GatherPlace>& places, int strata) {
  constexpr std::uint64_t kSeed = 0x9e3779b97f4a7c15;
  RayQueries queries(scene.accelerator());
  const auto sampler = make_hemisphere_sampler(scene, nullptr, nullptr, queries);
  HemisphereGrid grid(strata, 1e3f * scene.radius());
  std::vector<Gathered> all;
  for (std::size_t i = 0; i < places.size(); ++i) {
    sampler->gather(places[i], kSeed, static_cast<int>(i), grid);
    std::array<double, kReplicates> parts{};
    for (std::size_t s = 0; s < grid.size(); ++s) {
      parts[grid.replicate(s)] +=
          M_PI * kReplicates * static_cast<double>(grid.light(s).radiance.g) / static_cast<double>(grid.size());
    }
    Gathered g;
    for (const double part : parts) g.irradiance += part / kReplicates;
    for (const double part : parts) g.variance += (part - g.irradiance) * (part - g.irradiance) / (kReplicates * (kReplicates - 1));
    g.direct = direct_irradiance(scene, places[i]);
    all.push_back(g);
  }
  return all;
}

inline double mean_irradiance(const std::vector<Gathered>& all) {
  double mean = 0;
  for (const Gathered& g : all) mean += (g.irradiance + g.direct) / static_cast<double>(all.size());
  return mean;
}

// Indirect irradiance (green) at a place by all strata; empty: the cache knows nothing there.
inline std::optional<double> cached_irradiance(const IrradianceCache& cache, const GatherPlace& place) {
  double sum = 0;
  for (std::uint32_t replicate = 0; replicate < kReplicates; ++replicate) {
    const auto found = cache.interpolate({place.position, place.frame.n, place.room}, replicate);
    if (!found) return std::nullopt;
    sum += static_cast<double>(found->irradiance.g) / kReplicates;
  }
  return sum;
}

using MakeCache = std::function<IrradianceCache(const Scene& scene, std::uint64_t seed)>;

// At the quality of the 64 samples that a picture has by default.
inline IrradianceCache guarded_cache(const Scene& scene, std::uint64_t seed) {
  const IrradianceCache first = make_overture(scene, nullptr, nullptr, seed, quality_of(cache_level({0, 1})), 1, kNever).cache;
  return make_overture(scene, nullptr, &first, seed + 1000, quality_of(cache_level({16, 17})), 1, kNever).cache;
}

// A cache that covers the film, too, with records of what `strip` leaves of what is known of a place, and none refused.
inline MakeCache unguarded_cache(std::function<void(HemisphereIrradiance&)> strip) {
  return [strip](const Scene& scene, std::uint64_t seed) {
    const CacheQuality quality = quality_of(cache_level({16, 17}));
    RayQueries queries(scene.accelerator());
    const auto sampler = make_hemisphere_sampler(scene, nullptr, nullptr, queries);
    HemisphereGrid grid(quality.strata, 1e3f * scene.radius());
    std::vector<IrradianceRecord> records;
    IrradianceCache cache;
    for (int side = 1; side <= scene.film().width; side *= 2) {
      for (const GatherPlace& place : seen_places(scene, side)) {
        if (cache.covers({place.position, place.frame.n, place.room})) continue;
        sampler->gather(place, seed, static_cast<int>(records.size()), grid);
        HemisphereIrradiance light = grid.irradiance();
        strip(light);
        records.emplace_back(place.position, place.frame, place.room, light,
                             RecordLimits{quality.tolerance, 0.1f * kPi, 0.2f * scene.radius()});
        cache = IrradianceCache(records, quality.max_angle);
      }
    }
    return cache;
  };
}

// What caches are wrong by in the mean over seeds, over the mean of all irradiance of the places. Noise is taken off the mean of
// squares, so that interpolation is left; it adds to the largest. Where a cache knows nothing paths are traced, which are right.
struct CacheError {
  double rms = 0, largest = 0;
  double noise = 0;    // standard error of the largest one
  double one_rms = 0;  // of one cache, with its noise
  double covered = 0;  // part of the places
  double records = 0;  // of one cache
};

inline CacheError cache_error(const Scene& scene, const std::vector<GatherPlace>& places, const std::vector<Gathered>& truth,
                              const MakeCache& make, std::uint64_t seeds) {
  const auto n = static_cast<double>(seeds), count = static_cast<double>(places.size());
  const double mean = mean_irradiance(truth);
  std::vector<double> sum(places.size()), squares(places.size());
  CacheError error;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const IrradianceCache cache = make(scene, hash_words(seed, 77));
    error.records += static_cast<double>(cache.records().size()) / n;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const std::optional<double> found = cached_irradiance(cache, places[i]);
      if (!found) continue;
      error.covered += 1 / (n * count);
      const double difference = (*found - truth[i].irradiance) / mean;
      sum[i] += difference;
      squares[i] += difference * difference;
    }
  }
  double square = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double bias = sum[i] / n, variance = (squares[i] / n - bias * bias) / (n - 1) + truth[i].variance / (mean * mean);
    square += (bias * bias - variance) / count;
    error.one_rms += squares[i] / (n * count);
    if (std::fabs(bias) > error.largest) {
      error.largest = std::fabs(bias);
      error.noise = std::sqrt(variance);
    }
  }
  error.rms = std::sqrt(std::max(square, 0.0));
  error.one_rms = std::sqrt(error.one_rms);
  return error;
}

}  // namespace fluxfarm::testing
