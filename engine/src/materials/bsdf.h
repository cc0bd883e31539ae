// Scattering at a surface: value, sample, pdf.
//
// All directions are unit vectors in the local shading frame (z along the shading normal) and leave the point:
// wo towards where the path came from, wi towards where the light comes from. Transport is of radiance: transmission scales
// by (eta_wo / eta_wi)^2 as radiance does when it crosses into a denser medium.
// Objects are immutable and may be used by any number of threads.
#pragma once

#include <optional>

#include "math/rgb.h"
#include "math/vec.h"

namespace fluxfarm {

struct BsdfSample {
  Vec3f wi;
  Rgb weight;          // f |cos wi| / pdf for a continuous lobe; reflectance or transmittance over its probability for a delta
  float pdf = 0;       // solid angle, sr^-1; 0 for a delta direction
  bool delta = false;  // wi has probability mass: next-event estimation cannot find it
  // Goes on as if the surface was not there, which is no scattering. Only where `delta`.
  bool passes = false;
  float eta = 1;  // index of refraction on the side of wi over the one on the side of wo; 1 for reflection
};

struct BsdfValue {
  Rgb f;          // sr^-1, without cosine; delta lobes contribute nothing
  float pdf = 0;  // of sample() choosing wi, per steradian; delta lobes contribute nothing
};

class Bsdf {
 public:
  virtual ~Bsdf() = default;

  // f(wo, wi) and the density with which sample() would choose wi.
  virtual BsdfValue value(const Vec3f& wo, const Vec3f& wi) const = 0;

  // Chooses wi. Empty: no light is scattered to wo in this sample (absorbed, or wo is on a side that does not scatter).
  // `u_lobe` in [0,1) picks the lobe, `u` in [0,1)^2 the direction.
  virtual std::optional<BsdfSample> sample(const Vec3f& wo, float u_lobe, Vec2f u) const = 0;

  // Directional-hemispherical reflectance (plus transmittance) for the albedo layer: exact or a documented approximation.
  virtual Rgb albedo(const Vec3f& wo) const = 0;

  // False if every lobe is a delta: value() is zero everywhere.
  virtual bool has_continuous_lobe() const = 0;
  // Whether sample() looks at u_lobe.
  virtual bool chooses_lobe() const { return true; }
  // The two one-sided BSDFs of a two-sided one, each in a frame whose z points to its side; null for all others. Whoever knows the
  // side of wo may ask them directly and spare the detour.
  struct Sides {
    const Bsdf* front = nullptr;
    const Bsdf* back = nullptr;
  };
  virtual Sides sides() const { return {}; }
  // True if light can pass to the other side.
  virtual bool transmits() const { return false; }

  float pdf(const Vec3f& wo, const Vec3f& wi) const { return value(wo, wi).pdf; }
};

}  // namespace fluxfarm
