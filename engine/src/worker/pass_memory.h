// What was prepared for the last few passes that a worker was asked for: all tiles of a pass share it, and it may be large.
#pragma once

#include <atomic>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <optional>

#include "integrators/integrator.h"
#include "worker/messages.h"

namespace fluxfarm {

class PassMemory {
 public:
  explicit PassMemory(std::size_t capacity) : capacity_(capacity) {}

  // As Integrator::prepare_pass(), for the scene of `key`; one that was cancelled or failed is not kept. Safe to call from many
  // threads; those that ask for the same pass wait for each other.
  std::shared_ptr<const PreparedPass> find(const SceneKey& key, const Integrator& integrator, std::uint64_t seed,
                                           SampleRange samples, int threads, const std::atomic<bool>& cancelled);

 private:
  struct Entry {
    SceneKey key;
    std::uint64_t seed = 0;
    SampleRange samples;
    std::mutex mutex;                                         // of what follows
    std::optional<std::shared_ptr<const PreparedPass>> pass;  // nothing: not made so far; null: the method needs none
  };
  std::shared_ptr<Entry> entry(const SceneKey& key, std::uint64_t seed, SampleRange samples);

  std::mutex mutex_;
  std::size_t capacity_;
  std::list<std::shared_ptr<Entry>> entries_;  // most recently used first
};

}  // namespace fluxfarm
