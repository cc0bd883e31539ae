// How much of the disk of an estimate lies on the surface that asks, in sight of its middle, and whether a photon does.
//
// Photons in a disk tell about the light there if the disk is all surface. At a free edge, in a corner and around what stands on a
// surface it is not, and beyond a thin wall the surface goes on in other light. There the estimate over the disk is divided by
// the part c of the disk that is on the surface and in sight, and photons out of sight do not count: right in even light again.
// Where light is not even it is as biased as any estimate, and more at edges, where nothing balances a slope of the light.
//
// c is probed by rays, and one over a mean of few probes is not right in the mean. But the number of probes up to the first that
// succeeds has the mean 1 / c exactly, and is one, without noise, wherever the disk is all surface. Why so: docs/decisions/0010.
#pragma once

#include <cmath>

#include "accel/ray_queries.h"
#include "integrators/key_random.h"
#include "integrators/photon/surface_patch.h"
#include "math/frame.h"
#include "math/vec.h"
#include "scene/scene.h"

namespace fluxfarm {

class DiskInSight {
 public:
  // Everything outlives it. `radius`: m.
  DiskInSight(const Scene& scene, const SurfacePatch& patch, float radius, RayQueries& queries)
      : scene_(scene),
        patch_(patch),
        radius_(radius),
        frame_(patch.normal()),
        lifted_(patch.position() + patch.normal() * (kLift * radius)),
        queries_(queries) {}

  // One over the part of the disk, each place weighted as by the kernel, and the same of the disk of half the area; right in the
  // mean. Ones where next to nothing of it is found: there is no more to be told than without.
  struct InverseParts {
    float wide = 1, narrow = 1;
  };
  template <typename Kernel>
  InverseParts inverse_parts(const Kernel& kernel, KeyRandom& random) const {
    int narrow = 0;
    for (int probe = 1; probe <= kMaxProbes; ++probe) {
      const Vec2f u = random.next_2d();
      const float rho = radius_ * std::sqrt(kernel.sample(u.x)), phi = kTwoPi * u.y;
      const Vec2f place{rho * std::cos(phi), rho * std::sin(phi)};
      const bool found = meets_surface(place);
      // What is in sight has all that lies before it in sight, too.
      if (narrow == 0 && (found || meets_surface({kHalfArea * place.x, kHalfArea * place.y}))) narrow = probe;
      if (found) return {static_cast<float>(probe), static_cast<float>(narrow)};
    }
    return {};
  }

  // Whether nothing that stands on the surface is between the middle and a place of the patch (world, m) with that geometric normal
  // (unit). What hangs over it, as a ball on the floor does, hides nothing: there light has a slope on both sides.
  bool sees(Vec3f place, Vec3f normal) const;

 private:
  // Of a tenth of a disk nothing is found in 3 % of the cases.
  static constexpr int kMaxProbes = 32;
  // Over the radius: as high as the widest bulge that the tests of a patch let in rises above its chord.
  static constexpr float kLift = 0.05f;
  // Cosine between the normals of the surface and of what hangs over it, at least, and surfaces of that kind that a probe passes at
  // most (choices).
  static constexpr float kOverhang = 0.5f;
  static constexpr int kMostOverhangs = 2;
  static constexpr float kHalfArea = 0.70710678f;  // radius of a disk of half the area

  // Whether the patch goes on in sight above or below that place of the disk (local, m).
  bool meets_surface(Vec2f place) const;
  bool hangs_over(Vec3f normal) const { return std::fabs(dot(normal, frame_.n)) > kOverhang; }

  const Scene& scene_;
  const SurfacePatch& patch_;
  float radius_;  // m
  Frame frame_;
  Vec3f lifted_;  // the middle, m
  RayQueries& queries_;
};

}  // namespace fluxfarm
