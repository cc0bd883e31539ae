// Progressive photon mapping in scenes with media: paths and photons carry all the light once.
#include <gtest/gtest.h>

#include <cmath>

#include "integrators/photon/caustic_maps.h"
#include "integrators/photon/projection_pilot.h"
#include "integrators/photon/volume_estimate.h"
#include "integrators/photon_scenes.h"

namespace fluxfarm {
namespace {

using testing::cube;
using testing::kMaxZ;
using testing::kNever;
using testing::kReplicates;
using testing::kTwinZ;
using testing::Measurement;
using testing::render;
using testing::SceneBuilder;
using testing::summarize;

using Means = std::array<Measurement, 3>;

// Of each channel over the frame; seeds are independent, pixels, which share photons, are not.
Means frame_means(const SceneDescription& description, const char* method, std::uint32_t spp) {
  const Scene scene(description, 1);
  std::array<std::vector<double>, 3> values;
  for (std::uint64_t seed = 1; seed <= kReplicates; ++seed) {
    const FilmSummary summary = render(scene, method, spp, seed).summary();
    for (std::size_t channel = 0; channel < 3; ++channel) values[channel].push_back(summary.mean[channel]);
  }
  return {summarize(values[0]), summarize(values[1]), summarize(values[2])};
}

constexpr float kFirstRadius = 4;
SceneDescription seen_in_fog(const SceneBuilder& builder, const std::array<double, 3>& from, const std::array<double, 3>& at,
                             double pixel, int width, int height) {
  SceneDescription description = seen(builder, from, at, pixel, width, height);
  description.method.first_radius = kFirstRadius;
  return description;
}

// ---------------------------------------------------------------- a closed form

// A spot light 2.5 above the ground in fog shines down through a slab of glass from 1 to 1.5, which is filled with fog, too.
constexpr double kSigma = 0.4, kScattered = 0.8, kIndex = 1.5, kHeight = 0.5, kEye = 1.5;
SceneBuilder slab_in_fog(float g) {
  SceneBuilder builder;
  builder.floor(0, 20, builder.diffuse(0));
  builder.shape(cube(Transform::translate(0, 1.25, 0) * Transform::scale(20, 0.25, 20)),
                builder.add(DielectricDescription{kIndex}));
  builder.emitter(SpotEmitterDescription{{0, 2.5f, 0}, {0, -1, 0}, Rgb{1}, 10, 10});
  builder.camera_in(builder.medium({Rgb{kSigma}, Rgb{kScattered}, g}));
  return builder;
}

double transmitted(double cosine, double cosine_inside) {
  const double s = (cosine - kIndex * cosine_inside) / (cosine + kIndex * cosine_inside);
  const double p = (kIndex * cosine - cosine_inside) / (kIndex * cosine + cosine_inside);
  return 1 - (s * s + p * p) / 2;
}

// What a horizontal ray from (kEye, kHeight, 0) through the axis gets by one passage and one scattering: along the ray the light
// of a ring of directions arrives at a place x = r(angle) on each side of the axis.
double beam_radiance(double g, double sigma = kSigma, bool phase_function = true) {
  constexpr int kSteps = 4000;
  constexpr double kCutoff = 10 * M_PI / 180;
  const auto radius = [](double angle) {
    return (2 - kHeight) * std::tan(angle) + 0.5 * std::tan(std::asin(std::sin(angle) / kIndex));
  };
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double low = kCutoff * i / kSteps, high = kCutoff * (i + 1) / kSteps, angle = (low + high) / 2;
    const double cosine = std::cos(angle), inside = std::sqrt(1 - std::pow(std::sin(angle) / kIndex, 2));
    const double flux = 2 * M_PI * (std::cos(low) - std::cos(high)) * std::pow(transmitted(cosine, inside), 2);
    const double ring = M_PI * (std::pow(radius(high), 2) - std::pow(radius(low), 2));
    const double crossing = flux / (ring * cosine) * std::exp(-sigma * ((2 - kHeight) / cosine + 0.5 / inside));
    for (const double side : {-1.0, 1.0}) {
      const double deflection = side * std::sin(angle);  // its cosine, towards the eye
      const double phase = (1 - g * g) / (4 * M_PI * std::pow(1 + g * g - 2 * g * deflection, 1.5));
      sum +=
          crossing * (phase_function ? phase : 1) * std::exp(-sigma * (kEye - side * radius(angle))) * (radius(high) - radius(low));
    }
  }
  return kSigma * kScattered * sum;
}

TEST(PhotonsInMedia, ABeamThroughGlassHasItsClosedForm) {
  for (const float g : {0.0f, -0.4f}) {
    const auto g_exact = static_cast<double>(g);
    const SceneDescription beam = seen_in_fog(slab_in_fog(g).max_depth(4), {kEye, kHeight, 0}, {0, kHeight, 0}, 0.015, 4, 16);
    const Measurement m = frame_means(beam, "photon-progressive", 64)[1];
    const double expected = beam_radiance(g_exact);
    EXPECT_LT(m.standard_error, 0.005 * expected);
    EXPECT_NEAR(m.mean, expected, 0.005 * expected + kMaxZ * m.standard_error);
    EXPECT_GT(m.z(beam_radiance(g_exact, kSigma, false)), kTwinZ);  // no phase function
    EXPECT_GT(m.z(beam_radiance(g_exact, kSigma / 2)), kTwinZ);     // half the extinction
    EXPECT_GT(m.z(beam_radiance(g_exact - 0.3)), kTwinZ);
    EXPECT_EQ(frame_means(beam, "path", 16)[1].mean, 0);  // the path tracer never finds it
  }
}

TEST(PhotonsInMedia, PathsAreAsLongAsTheyMayBe) {
  const auto green = [](int max_depth) {
    const SceneDescription beam =
        seen_in_fog(slab_in_fog(0).max_depth(max_depth), {kEye, kHeight, 0}, {0, kHeight, 0}, 0.015, 4, 16);
    return frame_means(beam, "photon-progressive", 16)[1];
  };
  const Measurement all = green(-1);
  EXPECT_EQ(green(3).mean, 0);
  EXPECT_GT((all.mean - beam_radiance(0)) / all.standard_error, kTwinZ);  // with what was reflected or scattered on the way
}

TEST(PhotonsInMedia, ScatteredLightIsInTheVolumeLayer) {
  const Scene scene(seen_in_fog(slab_in_fog(0).max_depth(4), {kEye, kHeight, 0}, {0, kHeight, 0}, 0.015, 4, 16), 1);
  const auto integrator = make_integrator("photon-progressive", scene);
  const auto pass = integrator->prepare_pass(1, {0, 16}, 2, kNever);
  RayQueries queries(scene.accelerator());
  std::vector<CameraSample> samples;
  for (std::uint32_t i = 0; i < 16; ++i) samples.push_back({1, 1, i});
  std::vector<SampleResult> results(samples.size());
  integrator->radiance(samples, 1, pass.get(), results, queries);
  Rgb sum;
  for (const SampleResult& result : results) {
    EXPECT_EQ(result.layers[static_cast<std::size_t>(LightLayer::kVolume)], result.radiance);
    sum += result.radiance;
  }
  EXPECT_GT(sum.g, 0);
}

// What the second radius says of the bias is the bias: at the edge of the beam, where it is large.
TEST(PhotonsInMedia, BiasIsKnown) {
  const double edge = 1.5 * std::tan(M_PI / 18) + 0.5 * std::tan(std::asin(std::sin(M_PI / 18) / kIndex));
  const SceneDescription description = seen_in_fog(slab_in_fog(0).max_depth(4), {0, kHeight, kEye}, {edge, kHeight, 0}, 0.02, 8, 8);
  const double ratio = testing::claimed_over_real_bias(description, kFirstRadius, 1, 4);
  EXPECT_GT(ratio, 0.7);
  EXPECT_LT(ratio, 1.7);
}

// ---------------------------------------------------------------- against paths

// A glass ball in fog between a lamp of that side and a floor.
SceneBuilder glass_in_fog(const HomogeneousMediumDescription& medium, float lamp, bool glass = true) {
  SceneBuilder builder;
  const int fog = builder.medium(medium), clear = builder.medium({Rgb{0.0f}, Rgb{0.0f}, 0});
  builder.floor(0, 3, builder.diffuse(0.5f));
  builder.shape(SphereDescription{{0, 1.2f, 0}, 0.4f}, glass ? builder.add(DielectricDescription{1.5f}) : builder.diffuse(0.3f));
  builder.interior(clear);
  builder.exterior(fog);
  builder.lamp_down(0, 2.5f, 0, lamp, lamp, builder.diffuse(0), 1 / (lamp * lamp));
  builder.camera_in(fog);
  return builder;
}

const HomogeneousMediumDescription kGrey{Rgb{0.3f}, Rgb{0.9f}, 0};
const HomogeneousMediumDescription kColoured{{0.1f, 0.3f, 0.8f}, {1, 0.8f, 0.9f}, 0.3f};
const HomogeneousMediumDescription kForwards{{0.2f, 0.5f, 0.9f}, Rgb{0.9f}, 0.85f};  // scatters sharply in part

void expect_agreement(const Means& photons, const Means& paths, double precision) {
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const Measurement& both = photons[channel];
    const double expected = paths[channel].mean, error = std::hypot(both.standard_error, paths[channel].standard_error);
    EXPECT_LT(error, precision * expected) << channel;
    EXPECT_LT(std::fabs(both.mean - expected) / error, kMaxZ) << channel << ": " << both.mean << " for " << expected;
  }
}

// What the photons alone bring to the middles of the pixels if they are gathered as from that medium.
double beams_alone(const Scene& scene, const HomogeneousMedium& medium) {
  const ProjectionMap projection = caustic_projection(scene, caustic_photon_settings(scene));
  const CausticMaps maps(scene, &projection, 1, {0, 64}, 2, kNever);
  RayQueries queries(scene.accelerator());
  double sum = 0;
  int rays = 0;
  for (int y = 0; y < scene.film().height; ++y) {
    for (int x = 0; x < scene.film().width; ++x) {
      for (std::uint32_t sample = 0; sample < 64; ++sample, ++rays) {
        const Ray ray = scene.camera().ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        Hit hit;
        queries.intersect({&ray, 1}, {&hit, 1}, true);
        const float length = hit.shape == Hit::kNone ? ray.t_max : hit.t, width = scene.camera().pixel_angle();
        sum += static_cast<double>(
            scattered_along(maps.in_media(sample), {ray.origin, ray.direction, length, width, width}, medium, 32).value.g);
      }
    }
  }
  return sum / rays;
}

TEST(PhotonsInMedia, TheBeamBehindAGlassBallAgreesWithPaths) {
  SceneDescription beam = seen_in_fog(glass_in_fog(kGrey, 0.6f).max_depth(5), {2.5, 0.6, 0}, {0, 0.6, 0}, 0.06, 4, 8);
  beam.method.photons = 512;     // few for each sample: most noise is that of the paths
  beam.method.first_radius = 1;  // blur moves light out of the picture, which shows little more than the beam
  const Measurement photons = frame_means(beam, "photon-progressive", 768)[1], paths = frame_means(beam, "path", 3072)[1];
  const double error = std::hypot(photons.standard_error, paths.standard_error);
  EXPECT_LT(error, 0.01 * paths.mean);
  EXPECT_LT(std::fabs(photons.mean - paths.mean), 0.02 * paths.mean);
  EXPECT_LT(std::fabs(photons.mean - paths.mean) / error, kMaxZ);
  const Scene scene(beam, 1);
  const double right = beams_alone(scene, scene.media().front());
  const auto twin = [&](const HomogeneousMediumDescription& medium) {
    return photons.mean + beams_alone(scene, HomogeneousMedium(medium)) - right;
  };
  EXPECT_GT(std::fabs(twin({Rgb{0.15f}, Rgb{0.9f}, 0}) - paths.mean) / error, kTwinZ);    // half the extinction
  EXPECT_GT(std::fabs(twin({Rgb{0.3f}, Rgb{0.9f}, 0.4f}) - paths.mean) / error, kTwinZ);  // another phase function
}

TEST(PhotonsInMedia, WholePicturesAgreeWithPaths) {
  for (const auto& medium : {kColoured, kForwards}) {
    const auto picture = [](const HomogeneousMediumDescription& fog) {
      return seen_in_fog(glass_in_fog(fog, 1.5f).max_depth(8), {2.5, 1.0, 0}, {0, 0.65, 0}, 0.15, 12, 12);
    };
    const Means photons = frame_means(picture(medium), "photon-progressive", 32);
    expect_agreement(photons, frame_means(picture(medium), "path", 256), 0.03);
    HomogeneousMediumDescription wrong = medium;
    wrong.albedo = medium.albedo * 0.7f;
    const Measurement twin = frame_means(picture(wrong), "path", 64)[1];
    EXPECT_GT(std::fabs(photons[1].mean - twin.mean) / std::hypot(photons[1].standard_error, twin.standard_error), kTwinZ);
  }
}

TEST(PhotonsInMedia, WithoutGlassItIsThePathTracer) {
  for (const auto& medium : {kGrey, kColoured}) {
    const Scene scene(seen_in_fog(glass_in_fog(medium, 1, false), {2.5, 1.0, 0}, {0, 0.65, 0}, 0.1, 16, 16), 1);
    const FilmSummary both = render(scene, "photon-progressive", 16, 1).summary(), paths = render(scene, "path", 16, 1).summary();
    for (std::size_t channel = 0; channel < 3; ++channel) EXPECT_NEAR(both.mean[channel] / paths.mean[channel], 1, 1e-5);
    EXPECT_EQ(both.error_bias, 0);
  }
}

TEST(PhotonsInMedia, BitsDependOnNeitherThreadsNorTiles) {
  const Scene scene(seen_in_fog(glass_in_fog(kForwards, 0.5f), {2.5, 0.7, 0}, {0, 0.6, 0}, 0.03, 40, 40), 1);
  testing::expect_bits_of_neither_threads_nor_tiles(scene);
}

}  // namespace
}  // namespace fluxfarm
