#include "worker/pass_memory.h"

#include <algorithm>

namespace fluxfarm {

std::shared_ptr<const PreparedPass> PassMemory::find(const SceneKey& key, const Integrator& integrator, std::uint64_t seed,
                                                     SampleRange samples, int threads, const std::atomic<bool>& cancelled) {
  const std::shared_ptr<Entry> found = entry(key, seed, samples);
  const std::lock_guard lock(found->mutex);
  if (!found->pass) found->pass = integrator.prepare_pass(seed, samples, threads, cancelled);
  return *found->pass;
}

std::shared_ptr<PassMemory::Entry> PassMemory::entry(const SceneKey& key, std::uint64_t seed, SampleRange samples) {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find_if(
      entries_, [&](const auto& entry) { return entry->key == key && entry->seed == seed && entry->samples == samples; });
  if (found != entries_.end()) {
    entries_.splice(entries_.begin(), entries_, found);
  } else {
    const auto& made = entries_.emplace_front(std::make_shared<Entry>());
    made->key = key;
    made->seed = seed;
    made->samples = samples;
    if (entries_.size() > capacity_) entries_.pop_back();
  }
  return entries_.front();
}

}  // namespace fluxfarm
