// Radiance by photons under a beam, against what the BSDF itself makes of the beam.
#include <gtest/gtest.h>

#include <cmath>

#include "integrators/photon/scattered_photons.h"
#include "integrators/photon_scenes.h"

namespace fluxfarm {
namespace {

using testing::kMaxZ;
using testing::kTwinZ;
using testing::Measurement;
using testing::replicated;
using testing::SceneBuilder;
using testing::shoot;

// Radiance of a floor under a beam from `direction`, by photons and by its BSDF alone: the part that is not scattered sharply.
struct RadiancePair {
  Measurement photons;
  double expected;
};

RadiancePair floor_radiance(SceneBuilder& builder, Vec3f direction) {
  builder.emitter(DirectionalEmitterDescription{direction, Rgb{2}});
  const Scene scene(builder.description(), 1);
  const Ray ray{Vec3f{0.05f, 0, 0.1f} + 2 * normalize(Vec3f{0.5f, 1, 0}), -normalize(Vec3f{0.5f, 1, 0})};
  Hit hit;
  RayQueries(scene.accelerator()).intersect({&ray, 1}, {&hit, 1}, false);
  BsdfSpace space;
  const PathVertex vertex(scene, ray, hit, space);
  NearestPhotons nearest;
  RadiancePair pair;
  pair.photons = replicated([&](std::uint64_t seed) {
    const PhotonMap map(shoot(scene, {.photons = 60000, .seed = seed, .max_bounces = 1}).photons, 2);
    ScatteredPhotons scattered(vertex);
    const float radius_squared = scattered.add_nearest(map, SurfacePatch(vertex, 0.2f), map.size() + 1, 0.2f, 2, nearest);
    SampleResult result;
    scattered.add_to(result, Rgb{1}, radius_squared, {});
    return static_cast<double>(result.radiance.g);
  });
  const Vec3f wi = vertex.frame.to_local(-direction);
  const Rgb f = vertex.bsdf->value(vertex.wo, wi).f;
  pair.expected = 2 * static_cast<double>(f.g * std::fabs(wi.z) * (1 - sharpness(1 / max_component(f))));
  return pair;
}

TEST(RadianceEstimate, IsWhatTheBsdfMakesOfTheBeam) {
  const Vec3f beam = normalize(Vec3f{0.45f, -1, 0.1f});
  for (const MaterialDescription& material :
       {MaterialDescription{DiffuseDescription{Rgb{0.6f}}},
        MaterialDescription{RoughConductorDescription{{.perfect = true}, {.alpha_u = 0.3f, .alpha_v = 0.3f}}},
        MaterialDescription{RoughPlasticDescription{}}}) {
    SceneBuilder builder;
    builder.floor(0, 1, builder.add(material));
    const RadiancePair pair = floor_radiance(builder, beam);
    EXPECT_LT(pair.photons.z(pair.expected), kMaxZ) << pair.photons.mean << " for " << pair.expected;
    EXPECT_GT(pair.photons.z(pair.expected * 0.9), kTwinZ);
  }
}

TEST(RadianceEstimate, TakesTheCosineToTheShadingNormal) {
  SceneBuilder builder;
  MeshDescription mesh;
  mesh.positions = {{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}};
  mesh.normals.assign(4, normalize(Vec3f{-0.5f, 1, 0}));
  mesh.indices = {0, 1, 2, 0, 2, 3};
  builder.shape(mesh, builder.diffuse(0.6f));
  const Vec3f beam = normalize(Vec3f{0.45f, -1, 0.1f});
  const RadiancePair pair = floor_radiance(builder, beam);
  EXPECT_NEAR(pair.expected, 2 * 0.6 / M_PI * static_cast<double>(dot(-beam, mesh.normals[0])), 1e-5);
  EXPECT_LT(pair.photons.z(pair.expected), kMaxZ) << pair.photons.mean << " for " << pair.expected;
  EXPECT_GT(pair.photons.z(pair.expected * static_cast<double>(-beam.y / dot(-beam, mesh.normals[0]))),
            kTwinZ);  // the other cosine
}

TEST(RadianceEstimate, SeesTheSideOfTheEyeOrBothThroughGlass) {
  const Vec3f up_beam = normalize(Vec3f{0.2f, 1, 0});
  SceneBuilder plate;
  plate.floor(0, 1, plate.diffuse(0.6f));
  EXPECT_EQ(floor_radiance(plate, up_beam).photons.mean, 0);
  SceneBuilder frosted;
  frosted.floor(0, 1, frosted.add(RoughDielectricDescription{{1.5f}, {.alpha_u = 0.4f, .alpha_v = 0.4f}}));
  const RadiancePair pair = floor_radiance(frosted, up_beam);
  EXPECT_GT(pair.expected, 0.1);
  EXPECT_LT(pair.photons.z(pair.expected), kMaxZ) << pair.photons.mean << " for " << pair.expected;
}

}  // namespace
}  // namespace fluxfarm
