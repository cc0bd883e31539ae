#include "integrators/audit/light_audit.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "film/error_goal.h"
#include "film/tile_grid.h"
#include "integrators/audit/light_particle.h"
#include "integrators/key_random.h"
#include "integrators/path/path_vertex.h"
#include "support/error.h"
#include "support/parallel.h"

namespace fluxfarm {
namespace {

// One particle for so many pixels: with as many rays as a path, a sixty-fourth of what the first round costs.
constexpr std::int64_t kPixelsToAParticle = 4;
// Bounds of their number: small pictures need enough of them to tell anything (a choice), large ones no more.
constexpr std::int64_t kLeastParticles = 1 << 14, kMostParticles = 1 << 22;
// The sums of so many groups of particles are added in order, whatever thread made them.
constexpr std::uint32_t kGroups = 64;
// A surface on which such light falls scatters so much of it to the camera (a choice).
constexpr double kLeftBySurface = 0.5;
// Side of the squares of pixels in each of which one probe looks for smooth surfaces.
constexpr int kProbeSide = 4;

// What is asked of an audit.
struct Task {
  const Scene& scene;
  PixelRect crop;
  std::uint64_t seed;
  int threads;
  const std::atomic<bool>& cancelled;
  bool finds_caustics;

  void check() const {
    if (cancelled.load(std::memory_order_relaxed)) throw CancelledError();
  }
};

// Sums over particles, of one cell.
struct CellSums {
  double radiance = 0, squares = 0, unreachable = 0, sharp_squares = 0;
};

class Grid {
 public:
  explicit Grid(PixelRect crop) : crop_(crop), columns_((crop.width + kErrorTile - 1) / kErrorTile) {}

  // Cell of a place on the film, nothing outside the crop.
  std::optional<std::size_t> at(float x, float y) const {
    const int column = static_cast<int>(std::floor(x)) - crop_.x, row = static_cast<int>(std::floor(y)) - crop_.y;
    if (column < 0 || row < 0 || column >= crop_.width || row >= crop_.height) return std::nullopt;
    return static_cast<std::size_t>(row / kErrorTile) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column / kErrorTile);
  }

 private:
  PixelRect crop_;
  int columns_;
};

// Adds what particles leave, so that the squares are those of whole particles: the splats of one are not independent.
class GroupSums {
 public:
  explicit GroupSums(std::size_t count) : cells(count) {}

  void add(const ParticleTrace& trace, const Grid& grid) {
    arrived += trace.arrived;
    arrived_unreachable += trace.arrived_unreachable;
    arrived_rare += trace.arrived_rare;
    arrived_bright += trace.arrived_bright;
    own_.clear();
    for (const Splat& splat : trace.splats) {
      const std::optional<std::size_t> cell = grid.at(splat.x, splat.y);
      if (!cell) continue;
      if (splat.unreachable) {
        cells[*cell].unreachable += static_cast<double>(splat.radiance);
        continue;
      }
      cells[*cell].sharp_squares += splat.sharp_square;
      auto place = std::ranges::find(own_, *cell, &Own::cell);
      if (place == own_.end()) place = own_.insert(place, Own{*cell, 0});
      place->radiance += static_cast<double>(splat.radiance);
    }
    for (const Own& own : own_) {
      cells[own.cell].radiance += own.radiance;
      cells[own.cell].squares += own.radiance * own.radiance;
    }
  }

  std::vector<CellSums> cells;
  double arrived = 0, arrived_unreachable = 0, arrived_rare = 0, arrived_bright = 0;

 private:
  struct Own {
    std::size_t cell;
    double radiance;
  };
  std::vector<Own> own_;  // of the particle at hand
};

std::vector<GroupSums> trace_particles(const Task& task, std::uint32_t particles) {
  const ParticleTracer tracer(task.scene, task.seed, particles, task.finds_caustics);
  const Grid grid(task.crop);
  std::vector<GroupSums> groups(kGroups, GroupSums(make_tiles(task.crop, kErrorTile).size()));
  parallel_for(kGroups, task.threads, [&](std::size_t group, int) {
    prepare_render_thread();
    RayQueries queries(task.scene.accelerator());
    ParticleTrace trace;
    for (auto index = static_cast<std::uint32_t>(group); index < particles; index += kGroups) {
      task.check();
      tracer.trace(index, queries, trace);
      groups[group].add(trace, grid);
    }
  });
  return groups;
}

// Whether a ray through that point of the film goes on from its first surface by a delta lobe.
bool sees_smooth(const Scene& scene, RayQueries& queries, float x, float y, KeyRandom random) {
  const Camera& camera = scene.camera();
  const Ray ray = camera.has_lens() ? camera.ray(x, y, random.next_2d()) : camera.ray(x, y);
  Hit hit;
  queries.intersect({&ray, 1}, {&hit, 1}, false);
  if (hit.shape == Hit::kNone) return false;
  BsdfSpace space;
  const PathVertex vertex(scene, ray, hit, space);
  const float u_lobe = random.next_1d();
  const std::optional<BsdfSample> scatter = vertex.bsdf->sample(vertex.wo, u_lobe, random.next_2d());
  return scatter && scatter->delta;
}

void find_blind_shares(const Task& task, LightAudit& audit) {
  const std::vector<PixelRect> cells = make_tiles(task.crop, kErrorTile);
  parallel_for(cells.size(), task.threads, [&](std::size_t index, int) {
    task.check();
    prepare_render_thread();
    RayQueries queries(task.scene.accelerator());
    const std::vector<PixelRect> squares = make_tiles(cells[index], kProbeSide);
    int smooth = 0;
    for (const PixelRect& square : squares) {
      const auto key = (static_cast<std::uint64_t>(square.y) << 32) | static_cast<std::uint64_t>(square.x);
      KeyRandom random(task.seed, KeyRandom::kProbe, key);
      const Vec2f u = random.next_2d();
      const float x = static_cast<float>(square.x) + u.x * static_cast<float>(square.width);
      const float y = static_cast<float>(square.y) + u.y * static_cast<float>(square.height);
      smooth += sees_smooth(task.scene, queries, x, y, random);
    }
    audit.cells[index].blind = smooth / static_cast<double>(squares.size());
  });
}

}  // namespace

AuditNeed audit_need(const Scene& scene) {
  const Census& census = scene.census();
  if (scene.emitter_list().empty()) {
    return {AuditNeed::kNotNeeded,
            census.environment ? "a constant environment alone, which paths find with bounded weights" : "nothing emits"};
  }
  if (census.media > 0 || census.null_boundaries) {
    const bool unreachable = census.delta_lobes && census.point_emitters + census.spot_emitters + census.directional_emitters > 0;
    std::string reason = census.media > 0 ? "not modelled in media" : "not modelled with null boundaries";
    reason += unreachable ? ": no error goal is claimed where point, spot or directional emitters meet smooth surfaces"
                          : ": light that is never sampled goes unnoticed";
    return {AuditNeed::kNotPossible, std::move(reason), unreachable};
  }
  return {AuditNeed::kNeeded, "for an error goal: particles from the emitters look for light that paths miss"};
}

LightAudit audit_light(const Scene& scene, PixelRect crop, std::uint64_t seed, int threads, const std::atomic<bool>& cancelled,
                       bool finds_caustics) {
  const AuditNeed need = audit_need(scene);
  LightAudit audit;
  if (need.kind == AuditNeed::kNotPossible) {
    audit.outcome = need.unreachable && !finds_caustics ? LightAudit::kNotPossibleWithUnreachable : LightAudit::kNotPossible;
    return audit;
  }
  const std::vector<PixelRect> rects = make_tiles(crop, kErrorTile);
  audit.cells.resize(rects.size());
  if (need.kind == AuditNeed::kNotNeeded) return audit;

  const Task task{scene, crop, seed, threads, cancelled, finds_caustics};
  const std::int64_t pixels = crop.pixels();
  const auto particles = static_cast<std::uint32_t>(std::clamp(pixels / kPixelsToAParticle, kLeastParticles, kMostParticles));
  double arrived = 0, arrived_unreachable = 0, arrived_rare = 0, arrived_bright = 0;
  for (const GroupSums& group : trace_particles(task, particles)) {
    arrived += group.arrived;
    arrived_unreachable += group.arrived_unreachable;
    arrived_rare += group.arrived_rare;
    arrived_bright += group.arrived_bright;
    for (std::size_t i = 0; i < rects.size(); ++i) {
      const double scale = 1 / (static_cast<double>(particles) * static_cast<double>(rects[i].pixels()));
      audit.cells[i].radiance += group.cells[i].radiance * scale;
      audit.cells[i].variance += group.cells[i].squares * scale * scale;
      audit.cells[i].unreachable += group.cells[i].unreachable * scale;
      audit.cells[i].sharp_square += group.cells[i].sharp_squares * scale;
    }
  }
  if (arrived_unreachable > 0) audit.unreachable_share = arrived_unreachable / arrived;
  if (arrived_rare > 0 && !finds_caustics && scene.census().delta_lobes) {
    audit.rare_share = arrived_rare / arrived;
    audit.rare_brightness = kLeftBySurface * arrived_bright / arrived_rare;
  }
  if (audit.unreachable_share > 0 || audit.rare_share > 0) find_blind_shares(task, audit);
  return audit;
}

}  // namespace fluxfarm
