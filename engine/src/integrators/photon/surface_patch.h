// The part of a surface around a place whose photons tell about the place: nearness alone would take those of other surfaces, too,
// and of the far side of a thin one.
#pragma once

#include <cmath>

#include "integrators/path/path_vertex.h"
#include "integrators/photon/photon.h"
#include "math/vec.h"

namespace fluxfarm {

enum class PhotonSide { kFront, kBack, kBoth };

class SurfacePatch {
 public:
  // The photons on the side of wo, or on both where light passes the surface. `radius`: of the estimate, m.
  SurfacePatch(const PathVertex& vertex, float radius, PhotonKinds kinds = PhotonKinds::all())
      : SurfacePatch(vertex.point.position, vertex.point.geometric_normal, side_of(vertex), radius, kinds) {}
  // `normal`: geometric, on the front, unit.
  SurfacePatch(Vec3f position, Vec3f normal, PhotonSide side, float radius, PhotonKinds kinds = PhotonKinds::all())
      : position_(position),
        normal_(normal),
        packed_normal_(PhotonLight::packed_normal(normal)),
        side_(side),
        kinds_(kinds),
        max_plane_distance_(kFlatness * radius) {}

  Vec3f position() const { return position_; }  // world, m
  // Unit, on the side of wo; on the front where light passes the surface.
  Vec3f normal() const { return side_ == PhotonSide::kBack ? -normal_ : normal_; }
  float max_plane_distance() const { return max_plane_distance_; }  // m, of a photon's place from the tangent plane

  // Whether the patch goes on where a surface has that geometric normal (unit, on its front); `d` leads there from position().
  bool goes_on(Vec3f d, Vec3f normal) const { return near_plane(d) && turned_alike(normal); }

  // `d` leads from position() to the photon's place.
  bool accepts(Vec3f d, const PhotonLight& light) const {
    if (!near_plane(d)) return false;
    if (light.normal_bits() != packed_normal_ && !turned_alike(light.normal())) return false;
    if (side_ != PhotonSide::kBoth && light.at_front() != (side_ == PhotonSide::kFront)) return false;
    return kinds_.contains(light.kind());
  }

 private:
  // Both tests let a sphere's photons in up to 0.4 of its radius R: its cap of chord r rises by r^2 / (2 R) and turns by r / R.
  static constexpr float kFlatness = 0.2f;   // distance from the tangent plane over radius of the estimate
  static constexpr float kMinCosine = 0.9f;  // between the normals

  bool near_plane(Vec3f d) const { return std::fabs(dot(d, normal_)) <= max_plane_distance_; }
  bool turned_alike(Vec3f n) const {
    const float cosine = dot(n, normal_);
    return cosine >= 0 && cosine * cosine >= kMinCosine * kMinCosine * length_squared(n);
  }
  static PhotonSide side_of(const PathVertex& vertex) {
    if (vertex.surface->transmits) return PhotonSide::kBoth;
    const Vec3f wo = vertex.frame.to_world(vertex.wo);
    return dot(wo, vertex.point.geometric_normal) > 0 ? PhotonSide::kFront : PhotonSide::kBack;
  }

  Vec3f position_, normal_;
  std::uint32_t packed_normal_;
  PhotonSide side_;
  PhotonKinds kinds_;
  float max_plane_distance_;
};

}  // namespace fluxfarm
