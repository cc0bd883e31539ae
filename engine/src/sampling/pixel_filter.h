// Filter importance sampling: a camera sample falls at an offset drawn from the pixel filter and belongs to its own pixel with
// weight one, so tiles need no borders. All our filters are positive and separable.
//
// [Ernst06] M. Ernst, M. Stamminger, G. Greiner, "Filter Importance Sampling", IEEE Symposium on Interactive Ray Tracing 2006.
#pragma once

#include <vector>

#include "math/vec.h"

namespace fluxfarm {

enum class PixelFilterKind { kBox, kTent, kGaussian };

struct PixelFilterDescription {
  PixelFilterKind kind = PixelFilterKind::kGaussian;
  float radius = 0;     // pixels; box 0.5 and tent 1 by default, so 0 means the default
  float stddev = 0.5f;  // pixels; gaussian only, cut at four standard deviations
};

class PixelFilter {
 public:
  explicit PixelFilter(const PixelFilterDescription& description);

  // Offset from the pixel centre in pixels, with the filter as density; u in [0,1)^2.
  Vec2f sample(Vec2f u) const { return {sample_axis(u.x), sample_axis(u.y)}; }

 private:
  float sample_axis(float u) const;

  PixelFilterKind kind_;
  float radius_;
  std::vector<float> inverse_cdf_;  // gaussian only: offsets at equal steps of u
};

}  // namespace fluxfarm
