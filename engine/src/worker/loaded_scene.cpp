#include "worker/loaded_scene.h"

#include <chrono>

#include "integrators/audit/light_audit.h"
#include "io/scene_reader.h"
#include "support/error.h"
#include "worker/plan.h"

namespace fluxfarm {
namespace {

// The picture for which a method is asked, with what the scene says of it.
Picture settled(const LoadSceneRequest::Picture& asked, const SceneLoadedReply& info) {
  const PixelRect crop = asked.crop.empty() ? info.crop : asked.crop;
  if (!PixelRect{0, 0, info.width, info.height}.contains(crop)) {
    throw SettingError("crop = " + std::to_string(crop.x) + "," + std::to_string(crop.y) + " " + std::to_string(crop.width) + "x" +
                       std::to_string(crop.height) + ": expected a part of the frame, " + std::to_string(info.width) + "x" +
                       std::to_string(info.height) + " pixels");
  }
  return {crop, asked.seed, settled(asked.goal, info.scene_spp)};
}

}  // namespace

std::shared_ptr<const LoadedScene> load_scene(const LoadSceneRequest& request, int threads, const std::atomic<bool>& cancelled) {
  if (cancelled.load(std::memory_order_relaxed)) throw CancelledError();
  const auto start = std::chrono::steady_clock::now();
  SceneDescription description = read_scene(request.folder, request.entry, {});
  FilmDescription& film = description.film;
  if (request.width > 0 && request.height > 0 && (request.width != film.width || request.height != film.height)) {
    // Another size makes another frame: the file's crop has no meaning in it.
    film = {request.width, request.height, 0, 0, 0, 0, film.filter};
  }
  auto loaded = std::make_shared<LoadedScene>(LoadedScene{{}, Scene(description, threads), nullptr});
  const PixelRect full{0, 0, film.width, film.height};
  SceneLoadedReply& info = loaded->info;
  info.width = film.width;
  info.height = film.height;
  info.scene_spp = description.samples_per_pixel;
  info.crop = film.crop_width > 0 ? PixelRect{film.crop_x, film.crop_y, film.crop_width, film.crop_height} : full;
  const Picture picture = settled(request.picture, info);
  Method method = make_method(request.integrator, loaded->scene, picture, threads, cancelled);
  info.integrator = method.integrator->name();
  info.warnings = loaded->scene.warnings();
  info.plan_json = plan_json(loaded->scene, *method.integrator, method.choice ? &*method.choice : nullptr);
  loaded->integrator = std::move(method.integrator);
  if (const LightAudit* audit = method.known.audit(picture.seed)) loaded->audits->keep(picture.crop, picture.seed, *audit);
  loaded->pilot->keep(std::move(method.known));
  info.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return loaded;
}

LightAudit AuditMemory::find(const Scene& scene, const Integrator& integrator, PixelRect crop, std::uint64_t seed, int threads,
                             const std::atomic<bool>& cancelled) {
  const std::lock_guard lock(mutex_);
  if (!made_ || made_->crop != crop || made_->seed != seed) {
    made_ = Made{crop, seed, audit_light(scene, crop, seed, threads, cancelled, integrator.finds_caustics())};
  }
  return made_->audit;
}

SceneFuture SceneStore::find(const SceneKey& key) {
  const std::lock_guard lock(mutex_);
  for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
    if (entry->key != key) continue;
    entries_.splice(entries_.begin(), entries_, entry);
    return entries_.front().scene;
  }
  return {};
}

void SceneStore::keep(const SceneKey& key, SceneFuture scene) {
  const std::lock_guard lock(mutex_);
  entries_.remove_if([&](const Entry& entry) { return entry.key == key; });
  entries_.push_front({key, std::move(scene)});
  if (entries_.size() > capacity_) entries_.pop_back();
}

void SceneStore::forget(const SceneKey& key) {
  const std::lock_guard lock(mutex_);
  entries_.remove_if([&](const Entry& entry) { return entry.key == key; });
}

}  // namespace fluxfarm
