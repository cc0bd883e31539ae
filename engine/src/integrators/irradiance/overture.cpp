#include "integrators/irradiance/overture.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "integrators/irradiance/cached_irradiance.h"
#include "integrators/irradiance/clearance.h"
#include "integrators/irradiance/hemisphere_sampler.h"
#include "integrators/irradiance/neighbour_check.h"
#include "sampling/hash.h"
#include "support/error.h"
#include "support/parallel.h"

namespace fluxfarm {
namespace {

// Choices. Records that are used so near that they cover few pixels cost more than the paths that they spare.
constexpr float kLeastRoom = 0.4f;    // distance of what is nearest, over the side of what a pixel sees: nearer ones are not tried
constexpr float kLeastRadius = 1.5f;  // of a record, over the side of what a pixel sees
constexpr float kRefusedRadius = 3;   // the same, of the place around a refused one where no other is tried
constexpr float kLargestRadius = 0.2f;  // over that of the scene
constexpr int kMaxSurfaces = 16;        // on the way to a diffuse one
constexpr std::size_t kPixelsAtOnce = 64;
// relMSE divides by the square of a radiance plus 0.01: irradiance that makes 0.1 on a white surface.
constexpr float kLeastIrradiance = 0.1f * kPi;  // W m^-2

class OvertureBuilder {
 public:
  OvertureBuilder(const Scene& scene, const CausticMaps* caustics, const IrradianceCache* known, std::uint64_t seed,
                  const CacheQuality& quality, int threads, const std::atomic<bool>& cancelled)
      : scene_(scene), known_(known), seed_(seed), quality_(quality), threads_(threads), cancelled_(cancelled) {
    for (int i = 0; i < threads; ++i) workers_.emplace_back(std::make_unique<Worker>(scene, caustics, known));
  }

  Overture build() {
    const FilmDescription& film = scene_.film();
    int step = 1;
    while (step < std::max(film.width, film.height)) step *= 2;
    for (; step > 0; step /= 2) refine(step);
    Overture overture{std::move(cache_), 0};
    for (const auto& worker : workers_) overture.rays += worker->queries.rays();
    return overture;
  }

 private:
  struct Worker {
    Worker(const Scene& scene, const CausticMaps* caustics, const IrradianceCache* known)
        : queries(scene.accelerator()), sampler(make_hemisphere_sampler(scene, caustics, known, queries)) {}
    RayQueries queries;
    std::unique_ptr<HemisphereSampler> sampler;
  };

  void check_cancelled() const {
    if (cancelled_.load(std::memory_order_relaxed)) throw CancelledError();
  }

  // Looks at one pixel in step x step.
  void refine(int step) {
    const FilmDescription& film = scene_.film();
    const int columns = (film.width + step - 1) / step, rows = (film.height + step - 1) / step;
    std::vector<Look> found(static_cast<std::size_t>(columns) * rows);
    parallel_for((found.size() + kPixelsAtOnce - 1) / kPixelsAtOnce, threads_, [&](std::size_t group, int thread) {
      check_cancelled();
      prepare_render_thread();
      for (std::size_t i = group * kPixelsAtOnce; i < std::min(found.size(), (group + 1) * kPixelsAtOnce); ++i) {
        const int column = static_cast<int>(i) % columns, row = static_cast<int>(i) / columns;
        // Anywhere in the step's square, so that no two caches have records at the same places.
        const std::uint64_t bits = hash_words(seed_, step, i);
        const auto mask = static_cast<std::uint64_t>(step - 1);
        const int x = std::min(column * step + static_cast<int>(bits & mask), film.width - 1),
                  y = std::min(row * step + static_cast<int>(bits >> 32 & mask), film.height - 1);
        found[i] = look(x, y, static_cast<std::uint32_t>(step), workers_[static_cast<std::size_t>(thread)]->queries);
      }
    });
    std::vector<GatherPlace> places;
    for (const Look& look : found) {
      if (look.uncovered) places.push_back(*look.uncovered);
    }
    std::vector<Made> made(places.size());
    const int first = static_cast<int>(tried_);
    parallel_for(places.size(), threads_, [&](std::size_t i, int thread) {
      check_cancelled();
      prepare_render_thread();
      made[i] = make(places[i], first + static_cast<int>(i), *workers_[static_cast<std::size_t>(thread)]);
    });
    tried_ += places.size();
    for (std::size_t i = 0; i < made.size(); ++i) {
      if (made[i].light) {
        kept_.push_back({places[i], *made[i].light});
        records_.push_back(record(kept_.back()));
      } else {
        refused_records_.push_back(refused_record(places[i]));
      }
      if (made[i].nearest) near_points_.push_back(places[i].position + places[i].frame.to_world(*made[i].nearest));
    }
    // Seen by gathers at any step, and by this one.
    std::vector<Vec3f> points = near_points_;
    for (const Look& look : found) {
      if (look.surface) points.push_back(*look.surface);
    }
    keep_clear_of_all(points);
    check_by_neighbours();
    cache_ = IrradianceCache(records_, quality_.max_angle);
    refused_ = IrradianceCache(refused_records_, quality_.max_angle);
  }

  // A record, and a point before it.
  struct Blocked {
    std::uint32_t record;
    Vec3f point;
  };

  // Shrinks records where one of these points (of surfaces, world, m) stands before them that their own rays missed.
  void keep_clear_of_all(std::span<const Vec3f> points) {
    std::vector<Bounds> spaces;
    for (const IrradianceRecord& record : records_) spaces.push_back(record.space());
    const BoundsTree tree(spaces);
    std::vector<std::vector<Blocked>> all((points.size() + kPixelsAtOnce - 1) / kPixelsAtOnce);
    parallel_for(all.size(), threads_, [&](std::size_t group, int) {
      for (std::size_t p = group * kPixelsAtOnce; p < std::min(points.size(), (group + 1) * kPixelsAtOnce); ++p) {
        tree.for_each_near(points[p], [&](std::uint32_t i) {
          if (records_[tree.order()[i]].is_blocked_by(points[p])) all[group].push_back({tree.order()[i], points[p]});
          return true;
        });
      }
    });
    for (const std::vector<Blocked>& group : all) {
      for (const auto& [index, point] : group) {
        if (!records_[index].is_blocked_by(point)) continue;
        KeptRecord& kept = kept_[index];
        keep_clear_of(kept.place.frame.to_local(point - kept.place.position), kept.light.clearance);
        records_[index] = record(kept);
      }
    }
  }

  void check_by_neighbours() {
    std::vector<Bounds> spaces;
    for (const IrradianceRecord& record : records_) spaces.push_back(record.space(kCompared));
    const BoundsTree tree(spaces);
    std::vector<std::vector<std::uint32_t>> near(records_.size());
    parallel_for(near.size(), threads_, [&](std::size_t i, int) {
      tree.for_each_near(records_[i].position(), [&](std::uint32_t leaf) {
        const std::uint32_t other = tree.order()[leaf];
        if (records_[other].room() == records_[i].room()) near[i].push_back(other);
        return true;
      });
    });
    for (std::size_t i = 0; i < near.size(); ++i) {
      for (const std::uint32_t other : near[i]) check_by_neighbour(kept_[other], records_[other], kept_[i], quality_.max_angle);
    }
    for (std::size_t i = 0; i < records_.size(); ++i) records_[i] = record(kept_[i]);
  }

  // What the path through a pixel meets.
  struct Look {
    std::optional<Vec3f> surface;  // where it ends, world, m
    // The same, if that takes irradiance, no record covers it and none was refused there.
    std::optional<GatherPlace> uncovered;
  };
  Look look(int x, int y, std::uint32_t step, RayQueries& queries) const {
    Look look;
    const CameraSample sample{x, y, 0};
    SamplerBatch sampler;
    std::array<Ray, kMaxPaths> rays;
    start_camera_rays(scene_, {&sample, 1}, hash_words(seed_, step), sampler, rays);
    std::array<Vec2f, kMaxPaths> u;
    Ray ray = rays[0];
    float length = 0;
    const int max_depth = scene_.method().max_depth < 0 ? std::numeric_limits<int>::max() : scene_.method().max_depth;
    for (int depth = 0; depth < std::min(kMaxSurfaces, max_depth - 1); ++depth) {
      Hit hit;
      queries.intersect({&ray, 1}, {&hit, 1}, false);
      if (hit.shape == Hit::kNone) return look;
      BsdfSpace space;
      const PathVertex vertex(scene_, ray, hit, space);
      length += hit.t;
      look.surface = vertex.point.position;
      if (takes_irradiance(*vertex.surface)) {
        if (!(vertex.wo.z > 0) || vertex.bsdf->albedo(vertex.wo).is_black()) return look;
        const ReceivingPlace receiving = receiving_place(vertex, max_depth - depth);
        if (cache_.covers(receiving) || refused_.covers(receiving)) return look;
        // Where a cache with a larger tolerance has no record this one has none.
        if (known_ != nullptr && !known_->covers(receiving)) return look;
        look.uncovered =
            GatherPlace{vertex.point.position, vertex.frame, vertex.origin_towards(vertex.frame.n), depth, receiving.room, length};
        return look;
      }
      sampler.draw_2d(dimension_of(depth, kDirection), u);
      const std::optional<BsdfSample> scatter =
          vertex.bsdf->sample(vertex.wo, sampler.draw_1d(dimension_of(depth, kLobe), 0), u[0]);
      if (!scatter || !scatter->delta) return look;
      const Vec3f direction = vertex.frame.to_world(scatter->wi);
      ray = {vertex.origin_towards(direction), direction};
    }
    return look;
  }

  struct Made {
    std::optional<HemisphereIrradiance> light;  // empty: refused
    std::optional<Vec3f> nearest;               // of what was seen, in the frame of the place, m
  };
  Made make(const GatherPlace& place, int index, Worker& worker) const {
    const float footprint = footprint_of(place);
    const std::optional<Vec3f> nearest = nearest_point(place, worker.queries);
    if (nearest && length(*nearest) < kLeastRoom * footprint) return {{}, nearest};
    HemisphereGrid grid(quality_.strata, 1e3f * scene_.radius());
    worker.sampler->gather(place, seed_, index, grid);
    const KeptRecord kept{place, grid.irradiance()};
    const IrradianceRecord made = record(kept);
    const float least = kLeastRadius * footprint;
    if (!(made.larger_radius() * made.smaller_radius() >= least * least)) return {{}, kept.light.nearest};
    return {kept.light, kept.light.nearest};
  }

  // Side of what a pixel sees there, m.
  float footprint_of(const GatherPlace& place) const { return scene_.camera().pixel_angle() * place.length; }

  IrradianceRecord record(const KeptRecord& kept) const {
    const RecordLimits limits{quality_.tolerance, kLeastIrradiance, kLargestRadius * scene_.radius()};
    return {kept.place.position, kept.place.frame, kept.place.room, kept.light, limits};
  }

  // Stands for a place where none is kept.
  IrradianceRecord refused_record(const GatherPlace& place) const {
    HemisphereIrradiance flat;
    flat.irradiance = Rgb{1};
    return {place.position, place.frame, place.room, flat,
            RecordLimits{quality_.tolerance, kLeastIrradiance, kRefusedRadius * footprint_of(place)}};
  }

  const Scene& scene_;
  const IrradianceCache* known_;
  std::uint64_t seed_;
  CacheQuality quality_;
  int threads_;
  const std::atomic<bool>& cancelled_;
  std::vector<std::unique_ptr<Worker>> workers_;
  std::vector<KeptRecord> kept_;
  std::vector<Vec3f> near_points_;  // world, m
  std::vector<IrradianceRecord> records_, refused_records_;
  IrradianceCache cache_, refused_;
  std::size_t tried_ = 0;
};

}  // namespace

Overture make_overture(const Scene& scene, const CausticMaps* caustics, const IrradianceCache* known, std::uint64_t seed,
                       const CacheQuality& quality, int threads, const std::atomic<bool>& cancelled) {
  return OvertureBuilder(scene, caustics, known, seed, quality, threads, cancelled).build();
}

}  // namespace fluxfarm
