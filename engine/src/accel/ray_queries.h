// One thread's view of the ray accelerator: counts the rays, and keeps them when a benchmark wants to trace the same ones again.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accel/ray_accelerator.h"

namespace fluxfarm {

class RayQueries {
 public:
  explicit RayQueries(const RayAccelerator& accelerator) : accelerator_(accelerator) {}

  // As the accelerator's functions of the same names.
  void intersect(std::span<const Ray> rays, std::span<Hit> hits, bool coherent) {
    count(rays, false);
    accelerator_.intersect(rays, hits, coherent);
  }
  void occluded(std::span<const Ray> rays, std::span<bool> occluded_out, bool coherent) {
    count(rays, true);
    accelerator_.occluded(rays, occluded_out, coherent);
  }

  void record_to(std::vector<RecordedRay>* rays) { recording_ = rays; }
  std::uint64_t rays() const { return rays_; }

 private:
  void count(std::span<const Ray> rays, bool occlusion) {
    rays_ += rays.size();
    if (recording_ == nullptr) [[likely]]
      return;
    for (const Ray& ray : rays) recording_->push_back({ray, occlusion});
  }

  const RayAccelerator& accelerator_;
  std::uint64_t rays_ = 0;
  std::vector<RecordedRay>* recording_ = nullptr;
};

}  // namespace fluxfarm
