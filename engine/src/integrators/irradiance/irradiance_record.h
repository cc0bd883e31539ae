// Irradiance at one place, and how it changes around it.
//
// [Schwarzhaupt12] J. Schwarzhaupt, H. W. Jensen, W. Jarosz, "Practical Hessian-Based Error Control for Irradiance Caching", ACM
// TOG 31(6), 2012.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "integrators/irradiance/hemisphere_grid.h"
#include "math/bounds.h"
#include "math/frame.h"
#include "math/octahedral.h"
#include "math/rgb.h"
#include "math/rgbe.h"

namespace fluxfarm {

// The upper half of a float32, rounded: 8 bits of precision, for numbers that are noisy anyway.
class Bfloat16 {
 public:
  Bfloat16() = default;
  explicit Bfloat16(float value) : bits_(static_cast<std::uint16_t>((std::bit_cast<std::uint32_t>(value) + 0x7fff) >> 16)) {}
  float value() const { return std::bit_cast<float>(static_cast<std::uint32_t>(bits_) << 16); }

 private:
  std::uint16_t bits_ = 0;
};

// How well a record has to fit where it is used.
struct RecordLimits {
  // Error of the irradiance at the rim of where the record is used, over that irradiance: the change that its gradient leaves out.
  float tolerance = 0.1f;
  float least_irradiance = 0.1f;  // W m^-2, more than 0: where there is less, the error is over this one
  float max_radius = 1;           // m
};

class IrradianceRecord {
 public:
  // Paths with room for more have room for as many as they need.
  static constexpr int kMostRoom = 0xffff;

  IrradianceRecord() = default;
  // `frame` at `position` (world, m), z along the shading normal. `room`: of surfaces that light may have met, with this one, at
  // most kMostRoom. A record is used in an ellipse of the tangent plane that is smaller than each of several:
  // - where half of the Hessian times the distance squared is the tolerance [Schwarzhaupt12, there with the error over the area];
  // - the Hessian tells of the record's place alone: how it changes around that is not known, but goes with the cube of
  //   the distance over the one to what is near, and there is a distance at which that is the tolerance; even in the dark, for
  //   what is near may hide what shines;
  // - the same for errors that neighbours have found (neighbour_check.h);
  // - where the gradient would have doubled the irradiance, or left none of it;
  // - max_radius.
  IrradianceRecord(Vec3f position, const Frame& frame, int room, const HemisphereIrradiance& light, const RecordLimits& limits);

  Vec3f position() const { return position_; }
  Vec3f normal() const { return normalize(from_octahedral<16>(normal_)); }
  int room() const { return room_; }
  Rgb irradiance() const { return irradiance_; }
  // Semi-axes over the tangent plane, m.
  float larger_radius() const { return 1 / std::sqrt(eigenvalues()[0]); }
  float smaller_radius() const { return 1 / std::sqrt(eigenvalues()[1]); }
  Bounds bounds() const { return bounds(kFlat * (metric_xx_ + metric_yy_), 1); }
  // Of the space over where the record is used, or of that many times its radii: an ellipsoid that is as high as it is narrow.
  Bounds space(float radii = 1) const { return bounds(eigenvalues()[1] / (radii * radii), radii); }
  // Whether a point of another surface (world, m) stands well within that space.
  bool is_blocked_by(Vec3f point) const;

  // What the record says of a place.
  struct Use {
    float weight = 0;  // falls from one at the record to zero at its rim
    Rgb irradiance;    // W m^-2
    float error = 0;   // of its luminance by what the gradient leaves out, at most, as far as the record can tell, W m^-2
  };
  // On a surface at `place` with the shading normal `normal` (unit, towards the light). `per_angle_squared`: one over the square of
  // the angle (rad) between normals at which records are used no more.
  Use use_at(Vec3f place, Vec3f normal, float per_angle_squared) const;
  // The same without its weight, anywhere.
  Use extrapolate(Vec3f place, Vec3f normal) const {
    const Frame frame(this->normal());
    return extrapolate_local(frame.to_local(place - position_), frame.to_local(normal));
  }

  // For the part `replicate` of the samples: factors to irradiance() that bring the noise of its strata.
  Rgb replicate_share(std::uint32_t replicate) const { return from_rgbe(replicates_[replicate]); }

 private:
  // Part of the irradiance, or of that by what is near, by which it may change, at the distance of what is near, beyond what the
  // Hessian says (a choice: measured errors are smaller).
  static constexpr float kThirdOrder = 0.1f;

  // Choices, squared: radius over the distance from the tangent plane at which a record is used no more, and the same over the
  // distance from its surface, as far as normals tell of that: nothing on a flat one, and where it bends its normals lead to the
  // place (z = -n . d / 2, for it is a parabola). So it is not used on a surface behind its own, or before it.
  static constexpr float kFlat = 16, kSame = 1024;

  std::array<float, 2> eigenvalues() const;
  // `normal_metric`: as metric_, along the normal. `radii`: so many times as large over the tangent plane.
  Bounds bounds(float normal_metric, float radii) const;
  // Irradiance and error at a place, and for a normal, of the record's frame.
  Use extrapolate_local(Vec3f d, Vec3f n) const;

  Vec3f position_;
  std::uint32_t normal_ = 0;  // octahedral
  Rgb irradiance_;
  // One over the squares of the radii, as a matrix over the tangent plane, m^-2.
  float metric_xx_ = 0, metric_xy_ = 0, metric_yy_ = 0;
  std::array<Bfloat16, 3> turned_x_, turned_y_, gradient_x_, gradient_y_;  // R G B
  std::array<Bfloat16, 3> hessian_;                                        // xx, xy, yy
  std::array<Bfloat16, 3> third_order_;  // xx, xy, yy: the matrix whose product with a place, to the power 3/2, is an error
  Bfloat16 gradient_noise_;
  std::uint16_t room_ = 0;
  std::array<std::uint32_t, kReplicates> replicates_{};  // RGBE
};

inline IrradianceRecord::Use IrradianceRecord::use_at(Vec3f place, Vec3f normal, float per_angle_squared) const {
  // Most records are too far away: the lesser eigenvalue is above the determinant over the trace.
  const Vec3f way = place - position_;
  if (dot(way, way) * (metric_xx_ * metric_yy_ - metric_xy_ * metric_xy_) >= metric_xx_ + metric_yy_) return {};
  const Frame frame(this->normal());
  const Vec3f d = frame.to_local(way);
  const float across = metric_xx_ * d.x * d.x + 2 * metric_xy_ * d.x * d.y + metric_yy_ * d.y * d.y;
  const Vec3f n = frame.to_local(normal);
  const float off = std::min(std::fabs(d.z), std::fabs(d.z + (n.x * d.x + n.y * d.y) / 2));
  const float distance_squared = across + (metric_xx_ + metric_yy_) * (kFlat * d.z * d.z + kSame * off * off);
  if (!(distance_squared < 1)) return {};
  const float angle_squared = 2 * (1 - n.z) * per_angle_squared;
  if (!(angle_squared < 1)) return {};
  Use use = extrapolate_local(d, n);
  use.weight = (1 - std::sqrt(distance_squared)) * (1 - angle_squared);
  return use;
}

inline IrradianceRecord::Use IrradianceRecord::extrapolate_local(Vec3f d, Vec3f n) const {
  const auto linear = [&](float e, std::size_t c) {
    return e * n.z + turned_x_[c].value() * n.x + turned_y_[c].value() * n.y + gradient_x_[c].value() * d.x +
           gradient_y_[c].value() * d.y;
  };
  Use use;
  use.irradiance = {std::max(linear(irradiance_.r, 0), 0.0f), std::max(linear(irradiance_.g, 1), 0.0f),
                    std::max(linear(irradiance_.b, 2), 0.0f)};
  const float second = hessian_[0].value() * d.x * d.x + 2 * hessian_[1].value() * d.x * d.y + hessian_[2].value() * d.y * d.y;
  const float near =
      third_order_[0].value() * d.x * d.x + 2 * third_order_[1].value() * d.x * d.y + third_order_[2].value() * d.y * d.y;
  use.error = 0.5f * std::fabs(second) + near * safe_sqrt(near) + gradient_noise_.value() * std::sqrt(d.x * d.x + d.y * d.y);
  return use;
}

}  // namespace fluxfarm
