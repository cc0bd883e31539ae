#include "plain_record.h"

#include <algorithm>
#include <cmath>

namespace fluxfarm::ablation {
namespace {

constexpr double kLeastIrradiance = 1e-6;  // of a record, W m^-2, and its change, W m^-3: metrics divide by them
constexpr double kMinSpacingPixels = 0.5;  // of what is bounded; at less than a pixel a record hardly has neighbours
constexpr float kMaxAngle = 0.5f;          // between normals of a Hessian's record and its use, rad (a choice)
constexpr float kFlat = 16, kSame = 1024;  // as of IrradianceRecord
constexpr float kBehind = 0.01f;           // part of a record's spacing that a place may lie behind it
constexpr float kLeastDistance = 1e-6f;    // part of the spacing: weights divide by it

TangentMatrix circle(double radius) { return {1 / (radius * radius), 0, 1 / (radius * radius)}; }

PlaneGradient gradient_of(const KnownPlace& known, Gradient gradient) {
  switch (gradient) {
    case Gradient::kCells: return known.cell_gradient;
    case Gradient::kOcclusion: return known.occlusion_gradient;
    case Gradient::kNone: break;
  }
  return {};
}

// What bounds a radius: where the gradient would leave nothing of the irradiance, and the largest spacing; m.
struct Bound {
  double by_gradient, most, least;
};
Bound bound_of(const KnownPlace& known, const Method& method, const Limits& limits) {
  // Without gradients in the interpolation it takes the one of the cells.
  const PlaneGradient g = gradient_of(known, method.gradient == Gradient::kNone ? Gradient::kCells : method.gradient);
  const double steepness = std::max(static_cast<double>(std::hypot(g.x, g.y)), kLeastIrradiance);
  const auto pixel = static_cast<double>(known.pixel_m);
  return {static_cast<double>(known.irradiance) / steepness, static_cast<double>(limits.max_spacing_pixels) * pixel,
          kMinSpacingPixels * pixel};
}

double spacing(const KnownPlace& known, const Method& method, const Limits& limits) {
  const auto radius = static_cast<double>(known.harmonic_mean_m), tolerance = static_cast<double>(limits.tolerance);
  if (method.radius == Radius::kPureSplitSphere) return tolerance * radius;
  const Bound bound = bound_of(known, method, limits);
  return std::clamp(tolerance * std::min(radius, bound.by_gradient), bound.least, bound.most);
}

// Where the error of a Hessian over the ellipse is the tolerance, both over the irradiance.
TangentMatrix total_error(const TangentMatrix& hessian, double irradiance, double tolerance) {
  return with_eigenvalues(hessian, [=](double value) { return std::sqrt(M_PI * std::fabs(value) / (4 * tolerance * irradiance)); });
}

TangentMatrix ellipse(const KnownPlace& known, const Method& method, const Limits& limits) {
  const auto tolerance = static_cast<double>(limits.tolerance);
  const double irradiance = std::max(static_cast<double>(known.irradiance), kLeastIrradiance);
  switch (method.radius) {
    case Radius::kGeometricSum: return total_error(known.geometric_hessian.sum, 1, tolerance);
    case Radius::kGeometricBound: return total_error(known.geometric_hessian.bound, 1, tolerance);
    case Radius::kOcclusionRim:
      return with_eigenvalues(known.occlusion_hessian,
                              [=](double value) { return std::fabs(value) / (2 * tolerance * irradiance); });
    default: break;
  }
  const TangentMatrix whole = total_error(known.occlusion_hessian, irradiance, tolerance);
  if (method.radius == Radius::kOcclusion) return whole;
  // The gradient's bound is scaled as the radius is, by the tolerance's power of 1/4.
  const Bound bound = bound_of(known, method, limits);
  const double most = std::clamp(std::sqrt(std::sqrt(tolerance)) * bound.by_gradient, bound.least, bound.most);
  return with_eigenvalues(whole,
                          [=](double value) { return std::clamp(value, 1 / (most * most), 1 / (bound.least * bound.least)); });
}

}  // namespace

PlainRecord::PlainRecord(const KnownPlace& known, const Method& method, const Limits& limits, float scene_radius)
    : known_(&known),
      split_sphere_(is_split_sphere(method.radius)),
      per_tolerance_(1 / limits.tolerance),
      gradient_(gradient_of(known, method.gradient)),
      turns_(method.gradient != Gradient::kNone) {
  const double largest = static_cast<double>(scene_radius);
  if (split_sphere_) {
    metric_ = circle(std::min(spacing(known, method, limits), largest));
  } else {
    metric_ = ellipse(known, method, limits);
    add(metric_, circle(largest), 1);
  }
}

float PlainRecord::weight_by_sphere(const GatherPlace& place) const {
  const Vec3f d = place.position - known_->place.position;
  const float per_spacing = std::sqrt(static_cast<float>(metric_.xx));
  const float distance = length(d) * per_spacing;
  if (!(distance < 1)) return 0;
  const Vec3f n = known_->place.frame.n;
  const float error = distance + safe_sqrt(1 - dot(n, place.frame.n)) * per_tolerance_;
  if (!(error < 1) || dot(d, n + place.frame.n) / 2 * per_spacing < -kBehind) return 0;
  return 1 / std::max(error, kLeastDistance) - 1;
}

float PlainRecord::weight_by_ellipse(const GatherPlace& place) const {
  const Vec3f d = known_->place.frame.to_local(place.position - known_->place.position);
  const Vec3f n = known_->place.frame.to_local(place.frame.n);
  const float off = std::min(std::fabs(d.z), std::fabs(d.z + (n.x * d.x + n.y * d.y) / 2));
  const auto across = static_cast<float>(metric_.along(static_cast<double>(d.x), static_cast<double>(d.y)));
  const auto trace = static_cast<float>(metric_.xx + metric_.yy);
  const float distance_squared = across + trace * (kFlat * d.z * d.z + kSame * off * off);
  if (!(distance_squared < 1)) return 0;
  const float angle_squared = 2 * (1 - n.z) / (kMaxAngle * kMaxAngle);
  if (!(angle_squared < 1)) return 0;
  return (1 - std::sqrt(distance_squared)) * (1 - angle_squared);
}

PlainRecord::Told PlainRecord::told(const GatherPlace& place) const {
  Told told{known_->irradiance, known_->by_half};
  if (!turns_) return told;
  const Vec3f d = known_->place.frame.to_local(place.position - known_->place.position);
  const Vec3f n = known_->place.frame.to_local(place.frame.n);
  const float change = known_->turned_x * n.x + known_->turned_y * n.y + gradient_.x * d.x + gradient_.y * d.y;
  const auto moved = [&](float irradiance) { return std::max(irradiance * n.z + change, 0.0f); };
  return {moved(told.all), {moved(told.by_half[0]), moved(told.by_half[1])}};
}

}  // namespace fluxfarm::ablation
