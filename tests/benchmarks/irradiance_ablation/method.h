// The compared methods: how far a record is used, and with which gradient.
//
// [Ward88] G. Ward, F. Rubinstein, R. Clear, "A Ray Tracing Solution for Diffuse Interreflection", SIGGRAPH 1988.
// [WardHeckbert92] G. Ward, P. Heckbert, "Irradiance Gradients", EGWR 1992.
// [Krivanek06] J. Krivanek et al., "Making Radiance and Irradiance Caching Practical: Adaptive Caching and Neighbor Clamping", EGSR
// 2006.
// [Jarosz12] W. Jarosz et al., "Theory, Analysis and Applications of 2D Global Illumination", ACM TOG 31(5), 2012.
// [Schwarzhaupt12] J. Schwarzhaupt, H. W. Jensen, W. Jarosz, "Practical Hessian-Based Error Control for Irradiance Caching", ACM
// TOG 31(6), 2012.
#pragma once

#include <array>

namespace fluxfarm::ablation {

enum class Radius {
  kPureSplitSphere,     // tolerance times the harmonic mean distance [Ward88]
  kBoundedSplitSphere,  // the same, not more than where the gradient would leave nothing, and between bounds in pixels [Krivanek06]
  // Where the error of a Hessian over the whole ellipse is the tolerance: 4 t E / (pi |H|) to the power 1/4 [Jarosz12].
  kGeometricSum,      // of a geometric Hessian whose parts balance each other
  kGeometricBound,    // of one whose parts do not
  kOcclusion,         // of one that knows what hides [Schwarzhaupt12]
  kBoundedOcclusion,  // the same, with the bounds of kBoundedSplitSphere
  kOcclusionRim,      // where its error at the rim of the ellipse is the tolerance: the root of 2 t E / |H|, as of IrradianceRecord
};

enum class Gradient {
  kNone,
  kCells,      // [WardHeckbert92]
  kOcclusion,  // that knows what hides [Schwarzhaupt12], as of HemisphereIrradiance
};

struct Method {
  const char* name;
  Radius radius;
  Gradient gradient;
};

inline constexpr std::array kMethods{
    Method{"pure split-sphere, no gradients", Radius::kPureSplitSphere, Gradient::kNone},
    Method{"pure split-sphere", Radius::kPureSplitSphere, Gradient::kCells},
    Method{"bounded split-sphere, no gradients", Radius::kBoundedSplitSphere, Gradient::kNone},
    Method{"bounded split-sphere", Radius::kBoundedSplitSphere, Gradient::kCells},
    Method{"bounded split-sphere, occlusion gradients", Radius::kBoundedSplitSphere, Gradient::kOcclusion},
    Method{"geometric Hessian, bound", Radius::kGeometricBound, Gradient::kOcclusion},
    Method{"geometric Hessian, sum", Radius::kGeometricSum, Gradient::kOcclusion},
    Method{"occlusion Hessian", Radius::kOcclusion, Gradient::kOcclusion},
    Method{"occlusion Hessian, split-sphere's gradients", Radius::kOcclusion, Gradient::kCells},
    Method{"occlusion Hessian, bounded", Radius::kBoundedOcclusion, Gradient::kOcclusion},
    Method{"occlusion Hessian, error at the rim", Radius::kOcclusionRim, Gradient::kOcclusion},
};

struct Limits {
  float tolerance = 1;
  float max_spacing_pixels = 0;  // where is_bounded()
};

constexpr bool is_split_sphere(Radius radius) {
  return radius == Radius::kPureSplitSphere || radius == Radius::kBoundedSplitSphere;
}

constexpr bool is_bounded(Radius radius) { return radius == Radius::kBoundedSplitSphere || radius == Radius::kBoundedOcclusion; }

}  // namespace fluxfarm::ablation
