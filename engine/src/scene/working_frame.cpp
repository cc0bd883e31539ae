#include "scene/working_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include "math/bounds.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

constexpr double kFar = 16;           // times the radius: scenes farther from the origin are moved there
constexpr double kSmall = 0.25;       // m, radius of scenes that are enlarged
constexpr double kSmallest = 1e-9;    // m, radius of scenes that can be
constexpr double kRounding = 1e-4;    // of the radius: places rounded by more are warned of
constexpr double kNear = 0.1;         // times the offset of rays: near planes before that are warned of
constexpr double kHalfUlp = 0x1p-24;  // of a float's value, at most

struct Extent {
  std::array<double, 3> center{};
  double radius = 0;  // m
};

void extend(Bounds& bounds, const MeshDescription& mesh) {
  for (const Vec3f p : mesh.positions) bounds.extend(p);
}

void extend(Bounds& bounds, const RectangleDescription& rectangle) {
  for (const float x : {-1.0f, 1.0f}) {
    for (const float y : {-1.0f, 1.0f}) bounds.extend(rectangle.to_world.point({x, y, 0}));
  }
}

void extend(Bounds& bounds, const DiskDescription& disk) { extend(bounds, RectangleDescription{disk.to_world}); }

void extend(Bounds& bounds, const SphereDescription& sphere) {
  const Vec3f r{sphere.radius, sphere.radius, sphere.radius};
  bounds.extend(sphere.center - r);
  bounds.extend(sphere.center + r);
}

void extend(Bounds& bounds, const InstanceDescription& instance) {
  Bounds own;
  extend(own, *instance.mesh);
  for (int i = 0; i < 8; ++i) {
    const Vec3f corner{(i & 1 ? own.upper : own.lower).x, (i & 2 ? own.upper : own.lower).y, (i & 4 ? own.upper : own.lower).z};
    bounds.extend(instance.to_world.point(corner));
  }
}

// The place of a point or spot emitter; null for others.
const Vec3f* place_of(const EmitterDescription& emitter) {
  if (const auto* point = std::get_if<PointEmitterDescription>(&emitter)) return &point->position;
  if (const auto* spot = std::get_if<SpotEmitterDescription>(&emitter)) return &spot->position;
  return nullptr;
}

// Of all that has a place.
Extent extent_of(const SceneDescription& scene) {
  Bounds bounds;
  for (const ShapeDescription& shape : scene.shapes) {
    std::visit([&](const auto& geometry) { extend(bounds, geometry); }, shape.geometry);
  }
  bounds.extend(scene.camera.to_world.point({}));
  for (const EmitterDescription& emitter : scene.emitters) {
    if (const Vec3f* place = place_of(emitter)) bounds.extend(*place);
  }
  Extent extent;
  double squared = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double lower = static_cast<double>(bounds.lower[axis]), upper = static_cast<double>(bounds.upper[axis]);
    extent.center[static_cast<std::size_t>(axis)] = (lower + upper) / 2;
    squared += (upper - lower) * (upper - lower) / 4;
  }
  extent.radius = std::sqrt(squared);
  return extent;
}

double distance_of(const std::array<double, 3>& place) {
  return std::max({std::fabs(place[0]), std::fabs(place[1]), std::fabs(place[2])});
}

// How far rays leave surfaces at a place at most: as offset_point() (math/ray.h), 256 steps of a float or 2^-16 m.
double offset_at(Vec3f place) {
  const float reach = std::max({std::fabs(place.x), std::fabs(place.y), std::fabs(place.z)});
  return std::max(256 * static_cast<double>(std::nextafter(reach, std::numeric_limits<float>::infinity()) - reach), 0x1p-16);
}

// Whether some place is kept in single precision from the reader on.
bool has_rounded_places(const SceneDescription& scene) {
  for (const ShapeDescription& shape : scene.shapes) {
    if (std::holds_alternative<MeshDescription>(shape.geometry) || std::holds_alternative<SphereDescription>(shape.geometry)) {
      return true;
    }
  }
  return std::any_of(scene.emitters.begin(), scene.emitters.end(),
                     [](const auto& emitter) { return place_of(emitter) != nullptr; });
}

// The change of frame p' = enlargement (p - origin), a power of two, so that nothing is rounded by it.
class ChangeOfFrame {
 public:
  ChangeOfFrame(const std::array<double, 3>& origin, double enlargement)
      : origin_(origin),
        enlargement_(static_cast<float>(enlargement)),
        transform_(Transform::scale(enlargement, enlargement, enlargement) *
                   Transform::translate(-origin[0], -origin[1], -origin[2])) {}

  void apply_to(SceneDescription& scene) const {
    for (ShapeDescription& shape : scene.shapes) {
      std::visit([this](auto& geometry) { apply_to(geometry); }, shape.geometry);
    }
    for (EmitterDescription& emitter : scene.emitters) {
      std::visit([this](auto& description) { apply_to(description); }, emitter);
    }
    for (HomogeneousMediumDescription& medium : scene.media) medium.sigma_t = medium.sigma_t * (1 / enlargement_);
    for (MaterialDescription& material : scene.materials) {
      if (auto* bumps = std::get_if<BumpMapDescription>(&material)) bumps->scale *= enlargement_;
    }
    apply_to(scene.camera);
  }

 private:
  void apply_to(MeshDescription& mesh) const {
    for (Vec3f& p : mesh.positions) p = moved(p);
  }
  void apply_to(RectangleDescription& rectangle) const { rectangle.to_world = transform_ * rectangle.to_world; }
  void apply_to(DiskDescription& disk) const { disk.to_world = transform_ * disk.to_world; }
  void apply_to(InstanceDescription& instance) const { instance.to_world = transform_ * instance.to_world; }
  void apply_to(SphereDescription& sphere) const {
    sphere.center = moved(sphere.center);
    sphere.radius *= enlargement_;
  }

  void apply_to(PointEmitterDescription& point) const {
    point.position = moved(point.position);
    point.intensity = point.intensity * sqr(enlargement_);
  }
  void apply_to(SpotEmitterDescription& spot) const {
    spot.position = moved(spot.position);
    spot.intensity = spot.intensity * sqr(enlargement_);
  }
  // Light from outside has no place.
  void apply_to(DirectionalEmitterDescription&) const {}
  void apply_to(ConstantEmitterDescription&) const {}
  void apply_to(EnvmapEmitterDescription&) const {}

  void apply_to(CameraDescription& camera) const {
    camera.to_world = transform_ * camera.to_world;
    camera.near_clip *= enlargement_;
    camera.far_clip *= enlargement_;
    camera.aperture_radius *= enlargement_;
    camera.focus_distance *= enlargement_;
    camera.unit /= enlargement_;
  }

  Vec3f moved(Vec3f p) const {
    const auto along = [&](float value, std::size_t axis) {
      return static_cast<float>(static_cast<double>(enlargement_) * (static_cast<double>(value) - origin_[axis]));
    };
    return {along(p.x, 0), along(p.y, 1), along(p.z, 2)};
  }

  std::array<double, 3> origin_;
  float enlargement_;
  Transform transform_;
};

}  // namespace

WorkingDescription::WorkingDescription(const SceneDescription& description) : original_(description) {
  const Extent extent = extent_of(description);
  const double distance = distance_of(extent.center);
  if (description.shapes.empty() || !std::isfinite(distance) || !std::isfinite(extent.radius)) return;
  if (!(extent.radius >= kSmallest)) {
    std::ostringstream message;
    message << "has a radius of " << extent.radius << " m, expected at least " << kSmallest;
    throw SceneError("the scene", message.str());
  }
  const bool far = distance > kFar * extent.radius, small = extent.radius < kSmall;
  if (far || small) {
    changed_ = description;
    const double enlargement = small ? std::exp2(std::ceil(-std::log2(extent.radius))) : 1;
    ChangeOfFrame(far ? extent.center : std::array<double, 3>{}, enlargement).apply_to(*changed_);
  }
  const double rounding = distance * kHalfUlp;
  if (far && rounding > kRounding * extent.radius && has_rounded_places(description)) {
    std::ostringstream message;
    message << "the scene has a radius of " << extent.radius << " m and lies " << distance
            << " m from the origin: the places of its meshes, spheres and lamps are rounded by up to " << rounding
            << " m; put it near the origin";
    warnings_.push_back(message.str());
  }
  const CameraDescription& camera = get().camera;
  const double offset = offset_at(camera.to_world.point({}));
  if (static_cast<double>(camera.near_clip) < kNear * offset) {
    std::ostringstream message;
    message << "the sensor's near_clip = " << description.camera.near_clip << " m is far below the "
            << offset * static_cast<double>(camera.unit) << " m by which rays leave surfaces there: what is as small as that has "
            << "wrong light; leave out what is far away, put the sensor near the origin, or raise near_clip if nothing is so small";
    warnings_.push_back(message.str());
  }
}

}  // namespace fluxfarm
