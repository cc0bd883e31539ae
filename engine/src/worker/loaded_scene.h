// A scene ready to render, with its method, and the small store of them that a worker keeps between requests.
#pragma once

#include <atomic>
#include <future>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "film/light_audit.h"
#include "integrators/integrator.h"
#include "worker/messages.h"
#include "worker/pilot.h"

namespace fluxfarm {

// Keeps the audit that was made last: all rounds of a job ask for the same one.
class AuditMemory {
 public:
  // As audit_light(); one that was cancelled is not kept. Safe to call from many threads; they wait for each other.
  LightAudit find(const Scene& scene, const Integrator& integrator, PixelRect crop, std::uint64_t seed, int threads,
                  const std::atomic<bool>& cancelled);
  // Keeps one that was made elsewhere.
  void keep(PixelRect crop, std::uint64_t seed, const LightAudit& audit) {
    const std::lock_guard lock(mutex_);
    made_ = Made{crop, seed, audit};
  }

 private:
  struct Made {
    PixelRect crop;
    std::uint64_t seed;
    LightAudit audit;
  };
  std::mutex mutex_;
  std::optional<Made> made_;
};

// Keeps what a pilot made until the job has gone past it: photon maps and sums may be as large as the scene. Safe to use from many
// threads.
class PilotMemory {
 public:
  void keep(PilotSamples samples) { samples_ = std::make_shared<const PilotSamples>(std::move(samples)); }
  // Null once samples were asked for that it does not have.
  std::shared_ptr<const PilotSamples> find(SampleRange samples) {
    const std::lock_guard lock(mutex_);
    if (samples_ && !samples_->may_have(samples)) samples_.reset();
    return samples_;
  }

 private:
  std::mutex mutex_;
  std::shared_ptr<const PilotSamples> samples_;
};

struct LoadedScene {
  SceneLoadedReply info;
  Scene scene;
  std::unique_ptr<Integrator> integrator;
  std::unique_ptr<AuditMemory> audits = std::make_unique<AuditMemory>();
  std::unique_ptr<PilotMemory> pilot = std::make_unique<PilotMemory>();
};

// Reads, compiles and prepares. Throws SceneError, SettingError or ResourceError; CancelledError when it is cancelled.
std::shared_ptr<const LoadedScene> load_scene(const LoadSceneRequest& request, int threads, const std::atomic<bool>& cancelled);

// A scene that is there or on its way; get() waits for it and throws what loading it threw.
using SceneFuture = std::shared_future<std::shared_ptr<const LoadedScene>>;

// Keeps the most recently used scenes. Safe to use from many threads.
class SceneStore {
 public:
  explicit SceneStore(std::size_t capacity) : capacity_(capacity) {}

  // Not valid() when it is neither kept nor on its way.
  SceneFuture find(const SceneKey& key);
  void keep(const SceneKey& key, SceneFuture scene);
  void forget(const SceneKey& key);

 private:
  struct Entry {
    SceneKey key;
    SceneFuture scene;
  };
  std::mutex mutex_;
  std::size_t capacity_;
  std::list<Entry> entries_;  // most recently used first
};

}  // namespace fluxfarm
