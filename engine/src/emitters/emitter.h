// Sources of light as next-event estimation sees them.
//
// All but one can be chosen and sampled from a reference point. The constant environment cannot: from a surface the
// BSDF's own sampling finds it with less variance and without a choice of direction of its own (its share of the multiple
// importance weights is zero), so it only answers what radiance a ray that leaves the scene brings back.
#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include "emitters/emission_bounds.h"
#include "emitters/emitter_bounds.h"
#include "geometry/shape.h"
#include "math/ray.h"
#include "math/rgb.h"
#include "math/vec.h"

namespace fluxfarm {

// The distance of light from outside the scene.
inline constexpr float kDistant = std::numeric_limits<float>::infinity();

// Light that arrives at a reference point, if nothing is in between.
struct EmitterSample {
  Vec3f position;             // unused if `distance` is kDistant
  Vec3f normal;               // unit, on the side of the emitter that shines to the reference; zero for a point
  Vec3f wi;                   // unit, from the reference point towards the light
  float distance = 0;         // m
  Rgb weight;                 // radiance over pdf_solid_angle; for a delta light the irradiance across wi. W m^-2
  float pdf_solid_angle = 0;  // sr^-1; 0 for a delta light
  bool delta = false;         // one direction only: BSDF sampling cannot find it
};

// How large an emitter looks to what its light meets: the solid angle that all of it would fill if it shone everywhere as at the
// point that the light came from. Nothing for a delta light.
struct ApparentSize {
  float area = 0;         // of light from inside the scene: the emitter's area times the cosine at its point, m^2
  float solid_angle = 0;  // of light from outside: the inverse of the density of its direction, sr

  // sr, from so many metres away; light from outside may come from any distance, also 0.
  float from(float distance) const { return area > 0 ? area / (distance * distance) : solid_angle; }
};

// A ray on which light leaves an emitter, with the flux that it stands for.
struct EmissionSample {
  Ray ray;
  Rgb flux;            // what leaves in all, over the density of this ray, W
  bool delta = false;  // of a delta light: BSDF sampling from the other end cannot find it
  ApparentSize size = {};
  bool from_outside = false;  // has come through all that surrounds the scene
  Rgb intensity = {};         // along the ray, W sr^-1; of light from outside the irradiance across it, W m^-2
};

class Emitter {
 public:
  virtual ~Emitter() = default;
  // Chooses a point of the emitter as seen from `reference`. Empty: no light can come from there.
  virtual std::optional<EmitterSample> sample(Vec3f reference, Vec2f u) const = 0;
  // Chooses a ray that light leaves on; both u in [0,1)^2. Light from outside starts on the far side of a sphere around
  // `scene_center`. Empty: no light leaves there.
  virtual std::optional<EmissionSample> emit(Vec2f u_point, Vec2f u_direction, Vec3f scene_center) const = 0;
  // Holds every ray that emit() chooses for the random numbers of a cell.
  virtual EmissionBounds emission_bounds(const EmissionCell& cell, Vec3f scene_center) const = 0;
  virtual Rgb power() const = 0;  // W; of light from outside, what the scene can catch
  // Of its surface, m^2; 0 for a point and for light from outside.
  virtual float area() const { return 0; }
  // Where it is and whither it shines. Empty: it is outside the scene.
  virtual std::optional<EmitterBounds> bounds() const = 0;
};

// What a surface of that radiance sends from a chosen point of it. Empty: no point, or the reference point is behind it and it
// shines from its front only.
inline std::optional<EmitterSample> emitted_from(const std::optional<ShapeSample>& s, Rgb radiance, bool both_sides) {
  if (!s) return std::nullopt;
  const bool back = dot(s->normal, s->wi) >= 0;
  if (back && !both_sides) return std::nullopt;
  return EmitterSample{
      s->position, back ? -s->normal : s->normal, s->wi, s->distance, radiance / s->pdf_solid_angle, s->pdf_solid_angle, false};
}

// How large the emitter of a sample looks from the reference of that sample, sr.
inline float solid_angle_of(const Emitter& emitter, const EmitterSample& s) {
  if (s.delta) return 0;
  if (s.distance == kDistant) return 1 / s.pdf_solid_angle;
  return ApparentSize{emitter.area() * std::fabs(dot(s.normal, s.wi))}.from(s.distance);
}

// What a surface of that `power` and `area` (m^2) sends from a point that was chosen evenly over it: radiance is the same in all
// directions.
EmissionSample emitted_by(const AreaSample& point, Rgb power, float area, bool both_sides, Vec2f u_direction);
// What comes from outside in `direction` (world, unit), where a surface across it catches `irradiance`, through an even choice of
// points of the disk which the scene's sphere shows to it. `solid_angle` as in ApparentSize.
EmissionSample emitted_from_outside(Vec3f direction, Rgb irradiance, float solid_angle, Vec3f scene_center, float scene_radius,
                                    Vec2f u_point);

class AreaEmitter final : public Emitter {
 public:
  // Emits `radiance` (W m^-2 sr^-1) from the front side of `shape`, or from both; `shape` must outlive this.
  AreaEmitter(const Shape& shape, Rgb radiance, bool both_sides = false)
      : shape_(shape), radiance_(radiance), both_sides_(both_sides) {}

  std::optional<EmitterSample> sample(Vec3f reference, Vec2f u) const override;
  std::optional<EmissionSample> emit(Vec2f u_point, Vec2f u_direction, Vec3f) const override {
    return emitted_by(shape_.sample_area(u_point), power(), area(), both_sides_, u_direction);
  }
  Rgb power() const override { return radiance_ * ((both_sides_ ? kTwoPi : kPi) * area()); }
  float area() const override { return shape_.area(); }
  // As seen along a ray in direction `wi`, of which `point` is the end.
  ApparentSize apparent_size(const SurfacePoint& point, Vec3f wi) const {
    return {area() * std::fabs(dot(point.geometric_normal, wi)), 0};
  }
  EmissionBounds emission_bounds(const EmissionCell& cell, Vec3f) const override {
    return bounds_emitted_by(shape_.area_bounds(cell.point), both_sides_, cell.direction);
  }
  std::optional<EmitterBounds> bounds() const override;

  // Radiance that leaves `point` towards -wi, where wi is the direction in which the point is seen. Zero on a back that is dark.
  Rgb radiance(const SurfacePoint& point, Vec3f wi) const {
    return dot(point.geometric_normal, wi) < 0 || both_sides_ ? radiance_ : Rgb{};
  }
  const Shape& shape() const { return shape_; }
  Rgb radiance() const { return radiance_; }
  bool both_sides() const { return both_sides_; }

 private:
  const Shape& shape_;
  Rgb radiance_;
  bool both_sides_;
};

class PointEmitter final : public Emitter {
 public:
  // Intensity in W sr^-1.
  PointEmitter(Vec3f position, Rgb intensity) : position_(position), intensity_(intensity) {}

  std::optional<EmitterSample> sample(Vec3f reference, Vec2f u) const override;
  std::optional<EmissionSample> emit(Vec2f u_point, Vec2f u_direction, Vec3f scene_center) const override;
  EmissionBounds emission_bounds(const EmissionCell& cell, Vec3f) const override {
    return {NearRays({position_, 0}, cap_cone(cell.direction, 2))};
  }
  Rgb power() const override { return intensity_ * (4 * kPi); }
  std::optional<EmitterBounds> bounds() const override;

 private:
  Vec3f position_;
  Rgb intensity_;
};

}  // namespace fluxfarm
