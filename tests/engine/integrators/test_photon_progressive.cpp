// Progressive photon mapping as a whole: catalogue C8, C9, P6, and what it shares with all methods.
#include <gtest/gtest.h>

#include <cmath>

#include "integrators/photon_scenes.h"
#include "support/error.h"
#include "support/failure_row.h"
#include "support/sky.h"

namespace fluxfarm {
namespace {

using testing::cube;
using testing::kMaxZ;
using testing::kTwinZ;
using testing::Measurement;
using testing::percent;
using testing::render;
using testing::replicated;
using testing::SceneBuilder;
using testing::tell_failure;
using testing::told_by_auto;

// Of the green channel over the frame; seeds are independent, pixels, which share photons, are not.
Measurement frame_mean(const SceneDescription& description, const char* method, std::uint32_t spp) {
  const Scene scene(description, 1);
  return replicated([&](std::uint64_t seed) { return render(scene, method, spp, seed).summary().mean[1]; });
}

SceneDescription seen(const SceneBuilder& builder, const std::array<double, 3>& from, const std::array<double, 3>& at, double pixel,
                      int side = 4) {
  return testing::seen(builder, from, at, pixel, side, side);
}

// A lamp 2.5 above a screen, a slab of glass between them from 1 to 1.5 (catalogue C2). Straight through it the irradiance on the
// axis is 0.169273 for an intensity of one and an index of 1.5.
constexpr double kAlbedo = 0.5, kSinglePass = 0.169273;
SceneBuilder slab(float index = 1.5f) {
  SceneBuilder builder;
  builder.floor(0, 20, builder.diffuse(static_cast<float>(kAlbedo)));
  builder.shape(cube(Transform::translate(0, 1.25, 0) * Transform::scale(20, 0.25, 20)), builder.add(DielectricDescription{index}));
  builder.emitter(SpotEmitterDescription{{0, 2.5f, 0}, {0, -1, 0}, Rgb{1}, 10, 10});
  return builder;
}

TEST(PhotonProgressive, C8_CausticSeenThroughGlass) {
  // The longest path with one passage each way: two surfaces, the screen, two surfaces.
  const SceneDescription through = seen(slab().max_depth(6), {0.2, 3.5, 0}, {0, 0, 0}, 0.01);
  const double expected = kSinglePass * kAlbedo / M_PI * 0.9216;
  const Measurement m = frame_mean(through, "photon-progressive", 32);
  EXPECT_LT(m.standard_error, 0.005 * expected);
  EXPECT_NEAR(m.mean, expected, 0.005 * expected + kMaxZ * m.standard_error);
  EXPECT_GT(m.z(expected / 0.9216), kTwinZ);  // the second passage is not free
  const double by_paths = frame_mean(through, "path", 16).mean;
  EXPECT_EQ(by_paths, 0);  // the path tracer never finds it
  tell_failure("caustic seen through glass", "off", percent(by_paths / expected - 1) + " by paths");
  tell_failure("caustic seen through glass", "on", percent(m.mean / expected - 1, "%+.2f %%") + " by progressive photons");
  tell_failure("caustic seen through glass", "auto", told_by_auto(through, 0.1));
}

TEST(PhotonProgressive, PathsAreAsLongAsTheyMayBe) {
  // Seen from below a slab that reflects a quarter at each face: two surfaces and the screen, and what is reflected on the way
  // where paths may be longer.
  const auto below = [](int max_depth) {
    const SceneDescription description = seen(slab(3).max_depth(max_depth), {0.5, 0.9, 0}, {0, 0, 0}, 0.01);
    return frame_mean(description, "photon-progressive", 64);
  };
  const Measurement single = below(4), all = below(-1);
  const double expected = 0.75 * 0.75 / std::pow(2 + 0.5 / 3, 2) * kAlbedo / M_PI;
  EXPECT_EQ(below(3).mean, 0);
  EXPECT_NEAR(single.mean, expected, 0.005 * expected + kMaxZ * single.standard_error);
  EXPECT_LT(single.standard_error, 0.01 * expected);
  EXPECT_GT((all.mean - expected) / all.standard_error, kTwinZ);
}

// A mirror of that roughness faces a screen and a lamp of that side (0: a point) that shines up at it alone.
SceneDescription mirror(float alpha, double lamp) {
  SceneBuilder builder;
  builder.floor(0, 20, builder.diffuse(static_cast<float>(kAlbedo)));
  ConductorDescription metal{.perfect = true, .specular_reflectance = Rgb{0.8f}};
  const int material =
      alpha > 0 ? builder.add(RoughConductorDescription{metal, {MicrofacetDistribution::kGgx, alpha, alpha}}) : builder.add(metal);
  builder.shape(
      RectangleDescription{Transform::translate(0, 1.5, 0) * Transform::rotate(1, 0, 0, 90) * Transform::scale(0.8, 0.8, 1)},
      material);
  if (lamp > 0) {
    builder.shape(RectangleDescription{Transform::translate(0, 0.5, 0) * Transform::rotate(1, 0, 0, -90) *
                                       Transform::scale(lamp / 2, lamp / 2, 1)},
                  builder.diffuse(0), static_cast<float>(1 / (lamp * lamp)));
  } else {
    builder.emitter(SpotEmitterDescription{{0, 0.5f, 0}, {0, 1, 0}, Rgb{1}, 60, 60});
  }
  return seen(builder, {1.2, 0.8, 0}, {0.7, 0, 0}, 0.02);
}

// As if photons were used below a threshold of roughness alone: above it none is gathered, but paths leave them their share.
SceneDescription with_threshold(SceneDescription description, float alpha, float threshold) {
  if (alpha >= threshold) description.method.first_radius = 0;
  return description;
}

class RoughMirror : public ::testing::TestWithParam<float> {};

// Whatever the photons carry, both together carry all the light once.
TEST_P(RoughMirror, C9_PathsAndPhotonsShareTheLight) {
  const float alpha = GetParam();
  const Measurement paths = frame_mean(mirror(alpha, 0.4), "path", 8192);
  const auto z = [&](float threshold) {
    const Measurement both = frame_mean(with_threshold(mirror(alpha, 0.4), alpha, threshold), "photon-progressive", 256);
    const double error = std::hypot(both.standard_error, paths.standard_error);
    EXPECT_LT(error, 0.02 * paths.mean);
    return std::fabs(both.mean - paths.mean) / error;
  };
  EXPECT_LT(z(INFINITY), kMaxZ);
  // Twin; of rougher mirrors photons carry a tenth of the light or less, which is within the error.
  if (alpha < 0.2f) {
    EXPECT_GT(z(alpha), kTwinZ);
  }
}
INSTANTIATE_TEST_SUITE_P(Roughness, RoughMirror, ::testing::Values(0.0f, 0.05f, 0.1f, 0.15f, 0.2f, 0.4f));

// A ball of glass under a dim sky with a sun some ten degrees wide, which paths find, too: through the ball and by chance.
TEST(PhotonProgressive, AgreesWithPathsUnderASky) {
  LatLongImage sky{32, 17, std::vector<Rgb>(32 * 17, Rgb{0.1f})};
  sky.pixels[32 * 3 + 10] = Rgb{100.0f};
  SceneBuilder builder;
  builder.floor(0, 3, builder.diffuse(static_cast<float>(kAlbedo)));
  builder.shape(SphereDescription{{0, 0.5f, 0}, 0.4f}, builder.add(DielectricDescription{1.5f}));
  builder.emitter(EnvmapEmitterDescription{sky, Transform()});
  SceneDescription description = seen(builder, {2.5, 1, 0}, {0, 0.2, 0}, 0.2, 8);
  const Measurement paths = frame_mean(description, "path", 1024), both = frame_mean(description, "photon-progressive", 64);
  const double error = std::hypot(both.standard_error, paths.standard_error);
  EXPECT_LT(error, 0.01 * paths.mean);
  EXPECT_LT(std::fabs(both.mean - paths.mean) / error, kMaxZ) << both.mean << " for " << paths.mean;
  description.method.first_radius = 0;  // gathers no photon
  EXPECT_GT((paths.mean - frame_mean(description, "photon-progressive", 64).mean) / error, kTwinZ);
}

// From a mirror to a slightly rough one the caustic of a point light changes little; paths alone lose it at once.
TEST(PhotonProgressive, C9_NothingJumpsWithRoughness) {
  double largest = 0;  // from one roughness to the next
  const auto jumps = [&largest](float threshold) {
    double last = frame_mean(mirror(0, 0), "photon-progressive", 64).mean;
    largest = 0;
    for (const float alpha : {0.005f, 0.01f, 0.02f, 0.04f}) {
      const Measurement rough = frame_mean(with_threshold(mirror(alpha, 0), alpha, threshold), "photon-progressive", 64);
      largest = std::max(largest, std::fabs(rough.mean - last) / last);
      if (std::fabs(rough.mean - last) > 0.03 * last + kMaxZ * rough.standard_error) return true;
      last = rough.mean;
    }
    return false;
  };
  EXPECT_FALSE(jumps(INFINITY));
  tell_failure("growing roughness", "on", percent(largest) + " at most from step to step");
  EXPECT_TRUE(jumps(0.02f));
  tell_failure("growing roughness", "off", percent(largest) + " at a threshold of roughness");
  tell_failure("growing roughness", "auto", told_by_auto(mirror(0.02f, 0), 0.1));
  EXPECT_EQ(frame_mean(mirror(0, 0), "path", 64).mean, 0);
  EXPECT_GT(frame_mean(mirror(0.04f, 0), "path", 64).mean, 0.5 * frame_mean(mirror(0, 0), "photon-progressive", 64).mean);
}

// Mean squared error against the closed form over pixels and seeds, relative.
double squared_error(const Scene& scene, std::uint32_t spp, double expected) {
  return replicated([&](std::uint64_t seed) {
           const Film film = render(scene, "photon-progressive", spp, seed);
           double sum = 0;
           for (int y = 0; y < film.height(); ++y) {
             for (int x = 0; x < film.width(); ++x) {
               sum += std::pow(static_cast<double>(film.estimate(x, y).mean[1]) / expected - 1, 2);
             }
           }
           return sum / (film.width() * film.height());
         })
      .mean;
}

TEST(PhotonProgressive, P6_ErrorFallsWithTheTwoThirdsPower) {
  // Pixels so small that a photon seldom meets a disk: many in one would be spread more evenly than chance has it.
  const Scene scene(seen(slab().max_depth(4), {0.5, 0.9, 0}, {0, 0, 0}, 0.002, 16), 1);
  const double expected = kSinglePass * kAlbedo / M_PI;
  double sum_x = 0, sum_y = 0, sum_xx = 0, sum_xy = 0;
  constexpr int kPoints = 4;
  for (int i = 0; i < kPoints; ++i) {
    const std::uint32_t spp = 4u << (2 * i);
    const double x = std::log(spp), y = std::log(squared_error(scene, spp, expected));
    sum_x += x, sum_y += y, sum_xx += x * x, sum_xy += x * y;
  }
  const double slope = (kPoints * sum_xy - sum_x * sum_y) / (kPoints * sum_xx - sum_x * sum_x);
  EXPECT_NEAR(slope, -2.0 / 3, 0.1);  // neither -1, of a fixed radius, nor 0, of one that shrinks like a pixel's samples
}

TEST(PhotonProgressive, BitsDependOnNeitherThreadsNorTiles) {
  const Scene scene(seen(slab(), {0.2, 3.5, 0}, {0, 0, 0}, 0.01, 40), 1);
  testing::expect_bits_of_neither_threads_nor_tiles(scene);
  const auto middle = [&](std::uint64_t seed) { return render(scene, "photon-progressive", 5, seed).estimate(20, 20).mean; };
  EXPECT_NE(middle(3), middle(4));
}

// Where nothing scatters sharply it is the path tracer, bit by bit, with no bias and no photon; with a ball of glass it is not.
TEST(PhotonProgressive, IsPathTracingWhereNothingIsGlossy) {
  SceneBuilder builder;
  builder.floor(0, 3, builder.diffuse(0.5f)).lamp_down(0, 2, 0, 1, 1, builder.diffuse(0.2f), 3);
  const SceneDescription dull = seen(builder, {2, 1, 0}, {0, 0, 0}, 0.1, 16);
  builder.shape(SphereDescription{{0.5f, 0.5f, 0}, 0.3f}, builder.add(DielectricDescription{1.5f}));
  const SceneDescription glossy = seen(builder, {2, 1, 0}, {0, 0, 0}, 0.1, 16);
  const auto alike = [](const SceneDescription& description) {
    const Scene scene(description, 1);
    const Film photons = render(scene, "photon-progressive", 5, 3), paths = render(scene, "path", 5, 3);
    bool same = photons.biased() == paths.biased();
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 16; ++x) same &= photons.estimate(x, y).mean == paths.estimate(x, y).mean;
    }
    return same;
  };
  EXPECT_TRUE(alike(dull));
  EXPECT_FALSE(alike(glossy));
}

// What the second radius says of the bias is the bias: at the edge of a spot of light, where it is large.
TEST(PhotonProgressive, BiasIsKnown) {
  SceneBuilder builder;
  builder.floor(0, 3, builder.diffuse(static_cast<float>(kAlbedo)));
  builder.shape(
      RectangleDescription{Transform::translate(0, 1.5, 0) * Transform::rotate(1, 0, 0, 90) * Transform::scale(0.5, 0.5, 1)},
      builder.add(ConductorDescription{.perfect = true}));
  builder.emitter(SpotEmitterDescription{{0, 0.5f, 0}, {0, 1, 0}, Rgb{1}, 35, 35});
  // The image of the lamp is 2.5 above the screen, and the mirror ends at 1.25 there.
  const double ratio = testing::claimed_over_real_bias(seen(builder, {0, 1, 0}, {1.25, 0, 0}, 0.02, 8), 4, 0.5f, 16);
  EXPECT_GT(ratio, 0.7);  // half of it is claimed where bias is thought to go with the squared radius
  EXPECT_LT(ratio, 1.5);
}

TEST(PhotonProgressive, ScenesThatMakeNoSenseSaySo) {
  const auto refused = [](SceneBuilder& builder) -> std::string {
    const Scene scene(builder.look({0, 1, 1}, {0, 0, 0}).description(), 1);
    try {
      make_integrator("photon-progressive", scene);
    } catch (const SettingError& error) {
      return error.what();
    }
    return "";
  };
  SceneBuilder dark;
  dark.floor(0, 1, dark.diffuse(0.5f));
  EXPECT_NE(refused(dark).find("nothing in the scene emits light"), std::string::npos);
  SceneBuilder smooth;
  smooth.floor(0, 1, smooth.add(ConductorDescription{.perfect = true}));
  smooth.emitter(PointEmitterDescription{{0, 1, 0}, Rgb{1}});
  EXPECT_NE(refused(smooth).find("all surfaces of the scene are smooth"), std::string::npos);
}

}  // namespace
}  // namespace fluxfarm
