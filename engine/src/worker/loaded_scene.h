// A scene ready to render, with its method, and the small store of them that a worker keeps between requests.
#pragma once

#include <list>
#include <memory>
#include <mutex>
#include <string>

#include "integrators/integrator.h"
#include "worker/messages.h"

namespace fluxfarm {

struct LoadedScene {
  SceneLoadedReply info;
  Scene scene;
  std::unique_ptr<Integrator> integrator;
};

// Reads, compiles and prepares. Throws SceneError, SettingError or ResourceError.
std::shared_ptr<const LoadedScene> load_scene(const LoadSceneRequest& request, int threads);

// Keeps the most recently used scenes. Safe to use from many threads.
class SceneStore {
 public:
  explicit SceneStore(std::size_t capacity) : capacity_(capacity) {}

  // nullptr when it is not kept.
  std::shared_ptr<const LoadedScene> find(const SceneKey& key);
  void keep(const SceneKey& key, std::shared_ptr<const LoadedScene> scene);

 private:
  struct Entry {
    SceneKey key;
    std::shared_ptr<const LoadedScene> scene;
  };
  std::mutex mutex_;
  std::size_t capacity_;
  std::list<Entry> entries_;  // most recently used first
};

}  // namespace fluxfarm
