// What the tests of photons share: replicates of an estimate, shooting and rendering in one line, what a film says of its bias.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "integrators/photon/shoot_photons.h"
#include "support/scene_builder.h"
#include "worker/frame_renderer.h"

namespace fluxfarm::testing {

// Bound on |z| of means over kReplicates: Student's t with 15 degrees of freedom passes it with probability 0.9 %. Seeds are fixed.
inline constexpr double kMaxZ = 3;
// A twin with a fault must be as far away as this at least.
inline constexpr double kTwinZ = 5;
inline constexpr int kReplicates = 16;

inline Measurement summarize(const std::vector<double>& values) {
  Measurement m;
  const auto n = static_cast<double>(values.size());
  for (const double v : values) m.mean += v / n;
  double squares = 0;
  for (const double v : values) squares += (v - m.mean) * (v - m.mean);
  m.standard_error = std::sqrt(squares / (n * (n - 1)));
  return m;
}

// Of estimate(seed), a number, over as many seeds.
template <typename Estimate>
Measurement replicated(Estimate&& estimate) {
  std::vector<double> values;
  for (std::uint64_t seed = 1; seed <= kReplicates; ++seed) values.push_back(estimate(seed));
  return summarize(values);
}

inline ShotPhotons shoot(const Scene& scene, const PhotonSettings& settings, int threads = 2) {
  return shoot_photons(scene, PhotonTracer(scene, settings), {0, settings.photons}, std::size_t{1} << 26, threads, kNever);
}

// A ball of glass, a rough mirror and a lamp in a closed room of that albedo: everything at once. The lamp is so large that paths
// converge.
inline SceneBuilder room_with_balls(float albedo) {
  SceneBuilder builder;
  builder.shape(cube(Transform::scale(1.5, 1, 1.5)), builder.diffuse(albedo), 0, true);
  builder.lamp_down(0, 0.99f, 0, 1, 1, builder.diffuse(0), 2);
  builder.shape(SphereDescription{{0.5f, -0.5f, 0}, 0.35f}, builder.add(DielectricDescription{1.5f}));
  builder.shape(SphereDescription{{-0.5f, -0.5f, 0.2f}, 0.35f},
                builder.add(RoughConductorDescription{{.perfect = true, .specular_reflectance = Rgb{0.9f}},
                                                      {MicrofacetDistribution::kGgx, 0.15f, 0.15f}}));
  builder.look({0, 0, 1.4}, {0, -0.5, 0});
  return builder;
}

// Looks at a place, with pixels of so many metres there.
inline SceneDescription seen(SceneBuilder builder, const std::array<double, 3>& from, const std::array<double, 3>& at, double pixel,
                             int width, int height) {
  builder.look(from, at);
  SceneDescription description = builder.description();
  description.film.width = width;
  description.film.height = height;
  const double distance = std::hypot(from[0] - at[0], from[1] - at[1], from[2] - at[2]);
  description.camera.fov_degrees = static_cast<float>(2 * std::atan(width * pixel / 2 / distance) * 180 / M_PI);
  return description;
}

inline Film render(const Scene& scene, const char* method, std::uint32_t spp, std::uint64_t seed, int threads = 2, int tile = 64) {
  const PixelRect frame{0, 0, scene.film().width, scene.film().height};
  const auto integrator = make_integrator(method, scene);
  return render_frame(scene, *integrator, {frame, tile, threads, seed, {spp, {}, {}}}, kNever).film;
}

inline void expect_bits_of_neither_threads_nor_tiles(const Scene& scene, const char* method = "photon-progressive",
                                                     std::uint32_t spp = 5) {
  const Film one = render(scene, method, spp, 3, 1, 64), other = render(scene, method, spp, 3, 3, 16);
  for (int y = 0; y < one.height(); ++y) {
    for (int x = 0; x < one.width(); ++x) {
      ASSERT_EQ(one.estimate(x, y).mean, other.estimate(x, y).mean) << x << " " << y;
      ASSERT_EQ(one.bias_share(x, y), other.bias_share(x, y)) << x << " " << y;
    }
  }
}

// Root of the squared bias that pictures of 32 samples claim over that which they have. First radii are over a pixel's side; with
// the sharp one and 512 samples next to no bias is left. Squares are relative, and summed over pixels and seeds.
inline double claimed_over_real_bias(SceneDescription description, float blurred_radius, float sharp_radius, std::uint64_t seeds) {
  description.method.first_radius = blurred_radius;
  const Scene scene(description, 1);
  description.method.first_radius = sharp_radius;
  const Scene reference(description, 1);
  double claimed = 0, real = 0, noise = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const Film blurred = render(scene, "photon-progressive", 32, seed);
    const Film sharp = render(reference, "photon-progressive", 512, seed + 100);
    for (int y = 0; y < blurred.height(); ++y) {
      for (int x = 0; x < blurred.width(); ++x) {
        const PixelEstimate a = blurred.estimate(x, y), b = sharp.estimate(x, y);
        const double value = static_cast<double>(b.mean[1]), error = static_cast<double>(a.mean[1]) - value;
        const double variance =
            std::pow(static_cast<double>(a.standard_error[1]), 2) + std::pow(static_cast<double>(b.standard_error[1]), 2);
        claimed += blurred.bias_share(x, y);
        real += (error * error - variance) / (value * value + 1e-2);
        noise += variance / (value * value + 1e-2);
      }
    }
  }
  EXPECT_GT(real, 0.25 * noise);  // otherwise this tests nothing
  return std::sqrt(claimed / real);
}

}  // namespace fluxfarm::testing
