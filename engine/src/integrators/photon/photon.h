// A stored particle of light, in 24 bytes.
//
// What is lost: of the flux, all but 8 bits of the largest channel (rounded by a dither, so that sums are right in the mean); of
// the direction up to 0.004 degrees, of the normal up to 0.06 degrees.
//
// [Jensen96] H. W. Jensen, "Global Illumination using Photon Maps", EGWR 1996.
#pragma once

#include <algorithm>
#include <cstdint>

#include "math/octahedral.h"
#include "math/rgb.h"
#include "math/rgbe.h"
#include "math/vec.h"

namespace fluxfarm {

// What the light met between its emitter and the place where it is stored, on surfaces and in media. Surfaces that it passed as if
// they were not there do not count. Every photon is of one kind: a global map holds all of them, a caustic map the second and the
// third.
enum class PhotonKind : std::uint32_t {
  kDirect,    // nothing: L D
  kCaustic,   // mirrors and smooth refractions only: L S+ D
  kGlossy,    // sharp scattering (sharpness.h) only, and not of delta lobes alone
  kIndirect,  // anything else
};

// A set of kinds.
class PhotonKinds {
 public:
  constexpr PhotonKinds(PhotonKind kind) : bits_(1u << static_cast<std::uint32_t>(kind)) {}
  // What a caustic map holds.
  static constexpr PhotonKinds caustics() { return PhotonKinds(PhotonKind::kCaustic) | PhotonKind::kGlossy; }
  static constexpr PhotonKinds all() { return caustics() | PhotonKind::kDirect | PhotonKind::kIndirect; }
  constexpr bool contains(PhotonKind kind) const { return (bits_ >> static_cast<std::uint32_t>(kind) & 1) != 0; }
  friend constexpr PhotonKinds operator|(PhotonKinds a, PhotonKinds b) {
    a.bits_ |= b.bits_;
    return a;
  }

 private:
  std::uint32_t bits_;
};

// All of a photon but its place.
class PhotonLight {
 public:
  PhotonLight() = default;
  // `wi` (unit, world) leaves the surface towards where the light came from, `normal` (unit, world) is the geometric one on the
  // front of the surface; flux in W. `surfaces` on the way, with this one and with collisions in media: more than
  // kMostSurfaces count as so many. `dither` is even in [0,1).
  PhotonLight(Rgb flux, Vec3f wi, Vec3f normal, PhotonKind kind, int surfaces, float dither)
      : flux_(to_rgbe(flux, dither)),
        wi_(to_octahedral<16>(wi)),
        normal_and_way_(packed_normal(normal) << kWayBits |
                        static_cast<std::uint32_t>(std::min(surfaces, kMostSurfaces)) << kSurfacesShift |
                        (dot(wi, normal) > 0 ? kAtFront : 0) | static_cast<std::uint32_t>(kind)) {}
  // Of light that collides in a medium: there is no normal, and the flux is what the collision scatters.
  static PhotonLight in_medium(Rgb flux, Vec3f wi, PhotonKind kind, int surfaces, float dither) {
    return {flux, wi, wi, kind, surfaces, dither};
  }
  static constexpr int kMostSurfaces = 31;

  Rgb flux() const { return from_rgbe(flux_); }  // W
  // World, between 0.577 and 1 long.
  Vec3f wi() const { return from_octahedral<16>(wi_); }
  Vec3f normal() const { return from_octahedral<kNormalBits>(normal_bits()); }
  // Of normal(), to compare with packed_normal() without unpacking.
  std::uint32_t normal_bits() const { return normal_and_way_ >> kWayBits; }
  static std::uint32_t packed_normal(Vec3f normal) { return to_octahedral<kNormalBits>(normal); }
  PhotonKind kind() const { return static_cast<PhotonKind>(normal_and_way_ & (kAtFront - 1)); }
  bool at_front() const { return (normal_and_way_ & kAtFront) != 0; }  // whether it arrived on the front of the surface
  int surfaces() const { return static_cast<int>(normal_and_way_ >> kSurfacesShift) & kMostSurfaces; }

 private:
  static constexpr int kNormalBits = 12, kWayBits = 8, kSurfacesShift = 3;
  static constexpr std::uint32_t kAtFront = 4;
  std::uint32_t flux_ = 0, wi_ = 0, normal_and_way_ = 0;
};

struct Photon {
  Vec3f position;  // world, m
  PhotonLight light;
};
static_assert(sizeof(Photon) == 24);

}  // namespace fluxfarm
