// Caustics with closed forms: catalogue C1 to C7.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "integrators/photon/density_estimate.h"
#include "integrators/photon/density_kernel.h"
#include "integrators/photon_scenes.h"

namespace fluxfarm {
namespace {

using testing::cube;
using testing::kMaxZ;
using testing::kTwinZ;
using testing::Measurement;
using testing::replicated;
using testing::SceneBuilder;
using testing::shoot;

// A point light of intensity one that shines down into a cone of that half angle.
SpotEmitterDescription lamp(float height, float cutoff_degrees) {
  return {{0, height, 0}, {0, -1, 0}, Rgb{1}, cutoff_degrees, cutoff_degrees};
}

// Caustic irradiance on the screen y = 0 at (x, 0, 0).
Measurement caustic_at(const SceneDescription& description, float x, float radius, int max_bounces, std::uint64_t photons) {
  const Scene scene(description, 1);
  return replicated([&](std::uint64_t seed) {
    const PhotonSettings settings{.photons = photons, .seed = seed, .max_bounces = max_bounces, .kinds = PhotonKind::kCaustic};
    const PhotonMap map(shoot(scene, settings).photons, 2);
    const SurfacePatch patch({x, 0, 0}, {0, 1, 0}, PhotonSide::kFront, radius);
    return static_cast<double>(estimate_within(map, patch, radius, EpanechnikovKernel{}).value.g);
  });
}

TEST(PhotonCaustics, C1_PlaneMirrorMakesASecondLamp) {
  // The lamp shines up at a mirror 1.5 above the screen from 0.5 above it: its image stands 2.5 above.
  SceneBuilder builder;
  builder.floor(0, 3, builder.diffuse(0));
  builder.shape(
      RectangleDescription{Transform::translate(0, 1.5, 0) * Transform::rotate(1, 0, 0, 90) * Transform::scale(0.5, 0.5, 1)},
      builder.add(ConductorDescription{.perfect = true, .specular_reflectance = Rgb{0.8f}}));
  builder.emitter(SpotEmitterDescription{{0, 0.5f, 0}, {0, 1, 0}, Rgb{1}, 35, 35});
  const Measurement m = caustic_at(builder.description(), 0, 0.1f, -1, 120000);
  const double expected = 0.8 / (2.5 * 2.5);
  EXPECT_LT(m.z(expected), kMaxZ) << m.mean << " for " << expected;
  EXPECT_LT(m.standard_error, 0.02 * expected);
  EXPECT_GT(m.z(expected / 0.8), kTwinZ);
  // Cut where the mirror ends, seen from the image: at 0.5 * 2.5.
  EXPECT_GT(caustic_at(builder.description(), 1.1f, 0.1f, -1, 120000).mean, 0.05);
  EXPECT_EQ(caustic_at(builder.description(), 1.4f, 0.1f, -1, 120000).mean, 0);
}

// Screen at 0, slab of glass from 1 to 1.5, lamp at 2.5.
constexpr double kIndex = 1.5, kHeights = 2, kThickness = 0.5;

SceneDescription slab(float cutoff_degrees) {
  SceneBuilder builder;
  builder.floor(0, 20, builder.diffuse(0));
  builder.shape(cube(Transform::translate(0, 1.25, 0) * Transform::scale(20, 0.25, 20)),
                builder.add(DielectricDescription{static_cast<float>(kIndex)}));
  builder.emitter(lamp(2.5f, cutoff_degrees));
  return builder.description();
}

TEST(PhotonCaustics, C2_SlabOfGlassOnTheAxis) {
  const double reflectance = std::pow((kIndex - 1) / (kIndex + 1), 2), passes = std::pow(1 - reflectance, 2);
  double all = 0;  // each pair of inner reflections adds a farther lamp
  for (int pair = 0; pair < 6; ++pair) {
    all += passes * std::pow(reflectance, 2 * pair) / std::pow(kHeights + (2 * pair + 1) * kThickness / kIndex, 2);
  }
  const Measurement m = caustic_at(slab(10), 0, 0.1f, -1, 60000), single = caustic_at(slab(10), 0, 0.1f, 3, 60000);
  EXPECT_LT(m.z(all), kMaxZ) << m.mean << " for " << all;
  EXPECT_LT(single.z(0.169273), kMaxZ) << single.mean;
  EXPECT_LT(m.standard_error, 0.005 * all);
  EXPECT_GT(m.z(0.16), kTwinZ);  // straight on, as if the slab did not bring the lamp nearer
}

TEST(PhotonCaustics, C3_SlabOfGlassOffTheAxis) {
  const double angle = M_PI / 6;
  const auto ring = [](double outside) {
    return kHeights * std::tan(outside) + kThickness * std::tan(std::asin(std::sin(outside) / kIndex));
  };
  const double inside = std::asin(std::sin(angle) / kIndex);
  const double s = std::pow((std::cos(angle) - kIndex * std::cos(inside)) / (std::cos(angle) + kIndex * std::cos(inside)), 2);
  const double p = std::pow((kIndex * std::cos(angle) - std::cos(inside)) / (kIndex * std::cos(angle) + std::cos(inside)), 2);
  const double passes = 1 - (s + p) / 2;  // of unpolarised light at each face
  const double slope = (ring(angle + 1e-5) - ring(angle - 1e-5)) / 2e-5;
  const double expected = passes * passes * std::sin(angle) / (ring(angle) * slope);
  const Measurement m = caustic_at(slab(40), static_cast<float>(ring(angle)), 0.1f, 3, 200000);
  EXPECT_LT(m.z(expected), kMaxZ) << m.mean << " for " << expected;
  EXPECT_LT(m.standard_error, 0.02 * expected);
  EXPECT_GT(m.z(expected * 1.25), kTwinZ);
}

// Flux of the caustic photons, which come by so many surfaces at most, within `radius` (m) of each of the places, W.
std::vector<Measurement> fluxes_within(const SceneDescription& description, const std::vector<Vec3f>& places, float radius,
                                       int max_bounces, std::uint64_t photons) {
  const Scene scene(description, 1);
  std::vector<std::vector<double>> fluxes(places.size());
  for (std::uint64_t seed = 1; seed <= testing::kReplicates; ++seed) {
    const PhotonSettings settings{.photons = photons, .seed = seed, .max_bounces = max_bounces, .kinds = PhotonKind::kCaustic};
    for (std::vector<double>& flux : fluxes) flux.push_back(0);
    for (const Photon& photon : shoot(scene, settings).photons) {
      for (std::size_t i = 0; i < places.size(); ++i) {
        if (length(photon.position - places[i]) < radius) fluxes[i].back() += static_cast<double>(photon.light.flux().g);
      }
    }
  }
  std::vector<Measurement> result;
  for (const std::vector<double>& flux : fluxes) result.push_back(testing::summarize(flux));
  return result;
}

DirectionalEmitterDescription sun(Vec3f direction) { return {normalize(direction), Rgb{1}}; }

// ---------------------------------------------------------------- C4

// A ball of glass of diameter one. A ray at height b is turned twice by i - t and leaves as far from the middle as it came.
struct BallLens {
  double index = 1.5, radius = 0.5;

  double focal_length() const { return index * 2 * radius / (4 * (index - 1)); }  // from the middle
  // How far from the axis it meets the plane of the focus.
  double aberration(double b) const {
    const double turned = 2 * (std::asin(b / radius) - std::asin(b / radius / index));
    return std::fabs(focal_length() * std::tan(turned) - b / std::cos(turned));
  }
  double transmittance(double b) const {
    const double i = std::asin(b / radius), t = std::asin(b / radius / index);
    const double s = std::sin(i - t) / std::sin(i + t), p = std::tan(i - t) / std::tan(i + t);
    return std::pow(1 - s * s, 2) / 2 + std::pow(1 - p * p, 2) / 2;  // unpolarised light is polarised by the first face
  }
};

TEST(PhotonCaustics, C4_BallLensAndItsSphericalAberration) {
  const BallLens lens;
  EXPECT_DOUBLE_EQ(lens.focal_length(), 0.75);
  const auto behind = [](float index) {
    SceneBuilder builder;
    builder.floor(0, 0.5f, builder.diffuse(0));
    builder.shape(SphereDescription{{0, 0.75f, 0}, 0.5f}, builder.add(DielectricDescription{index}));
    builder.emitter(sun({0, -1, 0}));
    return builder.description();
  };
  for (const double beam : {0.1, 0.15}) {
    // A thin beam is within the aberration of third order, 10/9 b^3 / D^2 for this glass, of the focus: at b = D/10 in 1/90 of b.
    const double spot = lens.aberration(beam);
    EXPECT_NEAR(spot / (10.0 / 9 * std::pow(beam, 3)), 1, 3 * beam * beam / 0.25);
    double expected = 0;  // of all rays up to there: those farther out meet the plane farther out
    constexpr int kRings = 1000;
    for (int i = 0; i < kRings; ++i) {
      const double b = beam * (i + 0.5) / kRings;
      expected += 2 * M_PI * b * beam / kRings * lens.transmittance(b);
    }
    const auto through = [&](float index) {
      return fluxes_within(behind(index), {{0, 0, 0}}, static_cast<float>(spot), 3, 200000)[0];
    };
    const Measurement m = through(1.5f);
    EXPECT_LT(m.z(expected), kMaxZ) << beam << ": " << m.mean << " for " << expected;
    EXPECT_LT(m.standard_error, 0.02 * expected) << beam;
    EXPECT_GT(through(1.6f).z(expected), kTwinZ) << beam << ": the focus is elsewhere";
  }
}

// ---------------------------------------------------------------- C5

constexpr double kFacet = 0.02;  // side seen along the axis, of a mirror of radius one

// Concave mirror y = height(rho^2) of flat facets, seen from above, of which it takes an area (m^2).
struct Facets {
  MeshDescription mesh;
  double area = 0;
};
template <typename Height>
Facets facets(Height&& height) {
  Facets result;
  const int half = static_cast<int>(1 / kFacet);
  for (int i = -half; i < half; ++i) {
    for (int j = -half; j < half; ++j) {
      const double x = (i + 0.5) * kFacet, z = (j + 0.5) * kFacet;
      if (std::hypot(x, z) > 0.98) continue;
      const auto first = static_cast<std::uint32_t>(result.mesh.positions.size());
      for (const auto& [dx, dz] : {std::pair{-0.5, -0.5}, {-0.5, 0.5}, {0.5, 0.5}, {0.5, -0.5}}) {
        const double px = x + dx * kFacet, pz = z + dz * kFacet;
        result.mesh.positions.push_back(
            {static_cast<float>(px), static_cast<float>(height(px * px + pz * pz)), static_cast<float>(pz)});
      }
      for (const std::uint32_t corner : {0u, 1u, 2u, 0u, 2u, 3u}) result.mesh.indices.push_back(first + corner);
      result.area += kFacet * kFacet;
    }
  }
  return result;
}

TEST(PhotonCaustics, C5_ParabolicMirrorGathersAllLightAtItsFocus) {
  // A facet of a parabola has the slope that the parabola has at its middle: all it reflects goes the same way, as broad as it is,
  // and the disk at the focus sees that at angles up to 53 degrees.
  const double least = kFacet / std::sqrt(2.0) / std::cos(2 * std::atan(0.5)), radius = 1.1 * least;
  const auto gathered = [&](const Facets& mirror, double r) {
    SceneBuilder builder;
    builder.shape(mirror.mesh, builder.add(ConductorDescription{.perfect = true}));
    builder.shape(DiskDescription{Transform::translate(0, 1, 0) * Transform::rotate(1, 0, 0, 90) * Transform::scale(r, r, 1)},
                  builder.diffuse(0));
    builder.emitter(sun({0, -1, 0}));
    return fluxes_within(builder.description(), {{0, 1, 0}}, 0.1f, 2, 50000)[0];
  };
  const Facets parabola = facets([](double squared) { return squared / 4; });
  const double expected = parabola.area - M_PI * radius * radius;  // the disk stands in its own light
  const Measurement m = gathered(parabola, radius);
  EXPECT_LT(m.z(expected), kMaxZ) << m.mean << " for " << expected;
  EXPECT_LT(m.standard_error, 0.005 * expected);
  EXPECT_GT(gathered(parabola, 0.5 * least).z(parabola.area - M_PI * 0.25 * least * least), kTwinZ)
      << "the disk has that room only";
  // Twin: a sphere of the same focal length.
  EXPECT_GT(gathered(facets([](double squared) { return 2 - std::sqrt(4 - squared); }), radius).z(expected), kTwinZ);
}

// ---------------------------------------------------------------- C6

// Half a cup of radius one and height two with a mirror inside, its middle at the origin. The sun shines in at 45 degrees along x.
SceneDescription cup() {
  constexpr int kStrips = 1000;
  constexpr double kReach = 50 * M_PI / 180;  // to both sides
  MeshDescription wall;
  for (int i = 0; i <= kStrips; ++i) {
    const double angle = kReach * (2.0 * i / kStrips - 1);
    const auto x = static_cast<float>(std::cos(angle)), z = static_cast<float>(std::sin(angle));
    wall.positions.push_back({x, 0, z});
    wall.positions.push_back({x, 2, z});
  }
  for (std::uint32_t i = 0; i < 2 * kStrips; i += 2) {
    for (const std::uint32_t corner : {0u, 2u, 3u, 0u, 3u, 1u}) wall.indices.push_back(i + corner);
  }
  SceneBuilder builder;
  builder.floor(0, 1, builder.diffuse(0));
  builder.shape(wall, builder.add(ConductorDescription{.perfect = true}));
  builder.emitter(sun({1, -1, 0}));
  return builder.description();
}

// Light that a ray at distance b from the axis brings falls evenly on its way back over the floor: of the disk there it takes
// the length within it.
double nephroid_flux(double x, double radius) {
  double flux = 0;
  constexpr int kRays = 20000;
  const double reach = std::sin(50 * M_PI / 180);
  for (int i = 0; i < kRays; ++i) {
    const double b = reach * (2 * (i + 0.5) / kRays - 1), angle = std::asin(b);
    const double dx = -std::cos(2 * angle), dz = -std::sin(2 * angle);  // of the reflected ray from (cos angle, b)
    const double across = (x - std::cos(angle)) * dz + b * dx;
    if (std::fabs(across) < radius) flux += 2 * std::sqrt(radius * radius - across * across);
  }
  return flux * 2 * reach / kRays * std::sqrt(0.5);
}

TEST(PhotonCaustics, C6_NephroidHasItsCuspHalfWayToTheMirror) {
  // On the axis, closed form: the ray along it is focused at 1/2, and from there on two more cross.
  const auto on_axis = [](double x) { return 1 / std::fabs(2 * x - 1) + (x > 0.5 ? 2 / (4 * x * x - 1) : 0); };
  for (const double x : {0.3, 0.7}) {
    EXPECT_NEAR(nephroid_flux(x, 0.01) / (M_PI * 1e-4 * std::sqrt(0.5) * on_axis(x)), 1, 0.01) << x;
  }
  constexpr double kRadius = 0.03;
  const std::vector<double> distances{0.3, 0.45, 0.5, 0.55, 0.7};
  std::vector<Vec3f> places;
  for (const double x : distances) places.push_back({static_cast<float>(x), 0, 0});
  const std::vector<Measurement> m = fluxes_within(cup(), places, kRadius, 2, 200000);
  for (std::size_t i = 0; i < m.size(); ++i) {
    const double x = distances[i], expected = nephroid_flux(x, kRadius);
    EXPECT_LT(m[i].z(expected), kMaxZ) << x << ": " << m[i].mean << " for " << expected;
    EXPECT_LT(m[i].standard_error, 0.05 * expected) << x;
    if (x < 0.4 || x > 0.6) continue;
    // Twin: a cusp somewhere else.
    for (const double moved : {-0.05, 0.05}) EXPECT_GT(m[i].z(nephroid_flux(x + moved, kRadius)), kTwinZ) << x << moved;
  }
}

TEST(PhotonCaustics, C7_GlassNeitherMakesNorLosesFlux) {
  SceneBuilder builder;
  builder.floor(0, 20, builder.diffuse(0));
  builder.shape(SphereDescription{{0, 1, 0}, 0.5f}, builder.add(DielectricDescription{1.5f}));
  builder.emitter(lamp(3, 10));  // all of it meets the ball
  const Scene scene(builder.description(), 1);
  double emitted = 0;
  const Measurement m = replicated([&](std::uint64_t seed) {
    const ShotPhotons shot = shoot(scene, {.photons = 20000, .seed = seed});
    double flux = shot.ledger.escaped;  // reflected up
    for (const Photon& photon : shot.photons) {
      EXPECT_EQ(photon.light.kind(), PhotonKind::kCaustic);
      flux += static_cast<double>(photon.light.flux().g);
    }
    emitted = shot.ledger.emitted;
    return flux;
  });
  EXPECT_LT(m.z(emitted), kMaxZ) << m.mean << " of " << emitted;
  EXPECT_LT(m.standard_error, 0.002 * emitted);
}

}  // namespace
}  // namespace fluxfarm
