// One thread's view of the ray accelerator: counts the rays, and keeps them when a benchmark wants to trace the same ones again.
#pragma once

#include <cstdint>
#include <vector>

#include "accel/ray_accelerator.h"

namespace fluxfarm {

class RayQueries {
 public:
  explicit RayQueries(const RayAccelerator& accelerator) : accelerator_(accelerator) {}

  bool intersect(const Ray& ray, Hit& hit) {
    ++rays_;
    if (recording_ != nullptr) [[unlikely]] recording_->push_back({ray, false});
    return accelerator_.intersect(ray, hit);
  }
  bool occluded(const Ray& ray) {
    ++rays_;
    if (recording_ != nullptr) [[unlikely]] recording_->push_back({ray, true});
    return accelerator_.occluded(ray);
  }

  void record_to(std::vector<RecordedRay>* rays) { recording_ = rays; }
  std::uint64_t rays() const { return rays_; }

 private:
  const RayAccelerator& accelerator_;
  std::uint64_t rays_ = 0;
  std::vector<RecordedRay>* recording_ = nullptr;
};

}  // namespace fluxfarm
