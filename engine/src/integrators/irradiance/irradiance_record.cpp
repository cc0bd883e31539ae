#include "integrators/irradiance/irradiance_record.h"

#include <algorithm>

#include "integrators/irradiance/clearance.h"
#include "sampling/hash.h"

namespace fluxfarm {
namespace {

// Radii over each other at most (a choice): float32 has to hold both.
constexpr double kLongest = 20;

// Eigenvalues of a symmetric matrix, the lesser first, and the cosine and sine of the first one's direction.
struct Axes {
  double first, second;
  double cosine, sine;
};
Axes axes_of(const TangentMatrix& m) {
  const double middle = (m.xx + m.yy) / 2, half = (m.xx - m.yy) / 2;
  const double spread = std::hypot(half, m.xy);
  const double angle = 0.5 * std::atan2(-m.xy, -half);  // of the axis of the lesser one
  return {middle - spread, middle + spread, std::cos(angle), std::sin(angle)};
}
TangentMatrix matrix_of(const Axes& a) {
  return {a.first * a.cosine * a.cosine + a.second * a.sine * a.sine, (a.first - a.second) * a.cosine * a.sine,
          a.first * a.sine * a.sine + a.second * a.cosine * a.cosine};
}
// With its eigenvalues made positive.
TangentMatrix absolute(const TangentMatrix& m) {
  const Axes a = axes_of(m);
  return matrix_of({std::fabs(a.first), std::fabs(a.second), a.cosine, a.sine});
}

void add(TangentMatrix& sum, const TangentMatrix& m, double scale) {
  sum.xx += m.xx * scale;
  sum.xy += m.xy * scale;
  sum.yy += m.yy * scale;
}

// In axes turned by the angle of that cosine and sine.
TangentMatrix turned(const TangentMatrix& m, double c, double s) {
  return {m.xx * c * c - 2 * m.xy * c * s + m.yy * s * s, (m.xx - m.yy) * c * s + m.xy * (c * c - s * s),
          m.xx * s * s + 2 * m.xy * c * s + m.yy * c * c};
}

std::array<Bfloat16, 3> packed(const TangentMatrix& m) {
  return {Bfloat16(static_cast<float>(m.xx)), Bfloat16(static_cast<float>(m.xy)), Bfloat16(static_cast<float>(m.yy))};
}

float ratio(float part, float whole) { return whole > 0 ? part / whole : 1.0f; }

}  // namespace

IrradianceRecord::IrradianceRecord(Vec3f position, const Frame& frame, int room, const HemisphereIrradiance& light,
                                   const RecordLimits& limits)
    : position_(position),
      normal_(to_octahedral<16>(frame.n)),
      irradiance_(light.irradiance),
      room_(static_cast<std::uint16_t>(room)) {
  // What was found in `frame` goes into the one that use_at() makes of the packed normal.
  const Frame own(normal());
  const float c = dot(own.s, frame.s), s = dot(own.t, frame.s);
  const auto turn = [&](Rgb x, Rgb y, std::array<Bfloat16, 3>& own_x, std::array<Bfloat16, 3>& own_y) {
    const Rgb a = x * c - y * s, b = x * s + y * c;
    own_x = {Bfloat16(a.r), Bfloat16(a.g), Bfloat16(a.b)};
    own_y = {Bfloat16(b.r), Bfloat16(b.g), Bfloat16(b.b)};
  };
  turn(light.turned_x, light.turned_y, turned_x_, turned_y_);
  turn(light.gradient_x, light.gradient_y, gradient_x_, gradient_y_);

  const auto brightness = static_cast<double>(luminance(light.irradiance));
  const double allowed =
      static_cast<double>(limits.tolerance) * std::hypot(brightness, static_cast<double>(limits.least_irradiance));
  const auto steep_x = static_cast<double>(luminance(light.gradient_x)), steep_y = static_cast<double>(luminance(light.gradient_y));
  const double per_brightness = 1 / std::max(brightness, allowed), per_reach = 1 / static_cast<double>(limits.max_radius);
  // The sum of the ellipses' matrices lies in all of them.
  TangentMatrix metric;
  add(metric, absolute(light.hessian), 1 / (2 * allowed));
  const double contrast = static_cast<double>(kThirdOrder) *
                          std::max(brightness, static_cast<double>(std::max(light.near_irradiance, limits.least_irradiance)));
  TangentMatrix third_order;
  add(third_order, light.clearance, std::pow(contrast, 2.0 / 3));
  add(third_order, light.misfit, 1);
  add(metric, third_order, std::pow(allowed, -2.0 / 3));
  add(metric, {steep_x * steep_x, steep_x * steep_y, steep_y * steep_y}, per_brightness * per_brightness);
  add(metric, {1, 0, 1}, per_reach * per_reach);
  Axes axes = axes_of(metric);
  axes.first = std::max(axes.first, axes.second / (kLongest * kLongest));
  metric = turned(matrix_of(axes), static_cast<double>(c), static_cast<double>(s));
  metric_xx_ = static_cast<float>(metric.xx);
  metric_xy_ = static_cast<float>(metric.xy);
  metric_yy_ = static_cast<float>(metric.yy);
  hessian_ = packed(turned(light.hessian, static_cast<double>(c), static_cast<double>(s)));
  third_order_ = packed(turned(third_order, static_cast<double>(c), static_cast<double>(s)));
  gradient_noise_ = Bfloat16(light.gradient_noise);
  for (std::uint32_t i = 0; i < kReplicates; ++i) {
    const Rgb part = light.by_replicate[i], whole = light.irradiance;
    const float dither = static_cast<float>(mix_bits_32(normal_ + i) >> 8) * 0x1p-24f;
    replicates_[i] = to_rgbe({ratio(part.r, whole.r), ratio(part.g, whole.g), ratio(part.b, whole.b)}, dither);
  }
}

std::array<float, 2> IrradianceRecord::eigenvalues() const {
  const float middle = (metric_xx_ + metric_yy_) / 2, spread = std::hypot((metric_xx_ - metric_yy_) / 2, metric_xy_);
  return {middle - spread, middle + spread};
}

bool IrradianceRecord::is_blocked_by(Vec3f point) const {
  // Of the radius. Nearer its rim a record weighs little, and ordinary walls stand there (a choice).
  constexpr float kWithin = 0.8f;
  const Vec3f d = Frame(normal()).to_local(point - position_);
  if (!is_above_surface(d)) return false;
  return metric_xx_ * d.x * d.x + 2 * metric_xy_ * d.x * d.y + metric_yy_ * d.y * d.y + eigenvalues()[1] * d.z * d.z <
         kWithin * kWithin;
}

Bounds IrradianceRecord::bounds(float normal_metric, float radii) const {
  // Of an ellipsoid x^T M x <= 1 the extent along a direction is the root of the inverse there.
  const Frame frame(normal());
  const float determinant = metric_xx_ * metric_yy_ - metric_xy_ * metric_xy_;
  const auto extent = [&](float s, float t, float n) {
    const float tangential = (metric_yy_ * s * s - 2 * metric_xy_ * s * t + metric_xx_ * t * t) / determinant;
    return std::sqrt(std::max(tangential, 0.0f) * radii * radii + n * n / normal_metric);
  };
  const Vec3f half{extent(frame.s.x, frame.t.x, frame.n.x), extent(frame.s.y, frame.t.y, frame.n.y),
                   extent(frame.s.z, frame.t.z, frame.n.z)};
  return {position_ - half, position_ + half};
}

}  // namespace fluxfarm
