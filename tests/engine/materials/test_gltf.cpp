// The glTF material: samples against density, energy, reciprocity, and values worked out from the specification.
#include <gtest/gtest.h>

#include <random>

#include "cases.h"
#include "materials/charlie_sheen.h"
#include "sampling/warp.h"
#include "support/chi_square.h"

namespace fluxfarm::testing {
namespace {

constexpr double kOverallLevel = 0.01;
constexpr float kCosines[] = {0.6f, 0.1f, -0.5f};

struct GltfCase {
  std::string name;
  GltfDescription d;
};

std::vector<GltfCase> cases() {
  GltfDescription plain;
  plain.base_color = {0.8f, 0.5f, 0.2f};
  plain.metallic = 0;
  plain.roughness = 0.6f;
  std::vector<GltfCase> result{{"dielectric", plain}};
  GltfDescription d = plain;
  d.metallic = 1;
  result.push_back({"metal", d});
  d.anisotropy = 0.8f;
  d.anisotropy_rotation = 0.7f;
  result.push_back({"anisotropic metal", d});
  d = plain;
  d.metallic = 0.5f;
  d.clearcoat = 1;
  d.clearcoat_roughness = 0.5f;
  result.push_back({"coat over a mixture", d});
  d = plain;
  d.sheen_color = {0.9f, 0.7f, 0.3f};
  d.sheen_roughness = 0.6f;
  d.specular = 0.3f;
  result.push_back({"sheen", d});
  d = plain;
  d.transmission = 0.8f;
  result.push_back({"thin", d});
  d.thin = false;
  d.clearcoat = 0.5f;
  d.clearcoat_roughness = 0.6f;
  result.push_back({"volume", d});
  d = plain;
  d.base_color = Rgb{1};
  d.specular_color = {1, 0.5f, 3};
  d.ior = 2;
  result.push_back({"coloured specular", d});
  d.ior = 0;
  d.specular_color = Rgb{1};
  result.push_back({"all reflected", d});
  return result;
}

ChiSquareResult test_samples(const Bsdf& samples, const Bsdf& density, Vec3f wo) {
  return chi_square(
      {},
      [&](float u_lobe, Vec2f u) -> std::optional<Vec3f> {
        const auto s = samples.sample(wo, u_lobe, u);
        return s ? std::optional(s->wi) : std::nullopt;
      },
      [&](Vec3f wi) -> double { return density.pdf(wo, wi); });
}

TEST(GltfMaterial, SamplesFollowThePdfWhichIntegratesToTheProbabilityOfASample) {
  const int tests = static_cast<int>(cases().size() * std::size(kCosines));
  for (const GltfCase& c : cases()) {
    const auto bsdf = make(c.d);
    for (const float z : kCosines) {
      SCOPED_TRACE(c.name + " at cosine " + std::to_string(z));
      const ChiSquareResult r = test_samples(*bsdf, *bsdf, direction(z, 0.4f));
      EXPECT_GT(r.p_value, sidak_level(kOverallLevel, tests));
      EXPECT_NEAR(r.integral, r.success_fraction, 5 * std::sqrt(0.25 / 200000) + 2e-3);
    }
  }
}

// Twin: the density of a roughness ten percent away is told apart.
TEST(GltfMaterialTwin, DensityOfAnotherRoughnessIsRejected) {
  GltfDescription d = cases()[1].d;
  const auto samples = make(d);
  d.roughness *= 1.1f;
  EXPECT_LT(test_samples(*samples, *make(d), direction(0.6f, 0.4f)).p_value, 1e-12);
}

// Directional albedo; refracted light as flux.
Rgb sampled_albedo(const Bsdf& bsdf, Vec3f wo) {
  constexpr int kSamples = 60000;
  std::mt19937 generator(3);
  std::uniform_real_distribution<float> uniform(0, 1);
  Rgb sum;
  for (int i = 0; i < kSamples; ++i) {
    const auto s = bsdf.sample(wo, uniform(generator), {uniform(generator), uniform(generator)});
    if (s) sum += s->weight * (sqr(s->eta) / kSamples);
  }
  return sum;
}

TEST(GltfMaterial, NoMoreLightLeavesThanArrives) {
  for (GltfCase c : cases()) {
    c.d.base_color = Rgb{1};
    for (const float roughness : {0.15f, 0.6f, 1.0f}) {
      c.d.roughness = roughness;
      const auto bsdf = make(c.d);
      for (const float z : {1.0f, 0.6f, 0.2f, -0.5f})
        EXPECT_LE(max_component(sampled_albedo(*bsdf, direction(z, 0.4f))), 1.01f) << c.name << " " << roughness << " " << z;
    }
  }
}

TEST(GltfMaterial, IsReciprocal) {
  std::mt19937 generator(11);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (const GltfCase& c : cases()) {
    const auto bsdf = make(c.d);
    int pairs = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vec3f wo = direction(1.9f * uniform(generator) - 0.95f, kTwoPi * uniform(generator));
      const auto s = bsdf->sample(wo, uniform(generator), {uniform(generator), uniform(generator)});
      if (!s || std::abs(s->wi.z) < 0.05f || std::abs(wo.z) < 0.05f) continue;
      // Radiance scales by the square of the index on each side.
      const auto index2 = [&](Vec3f w) { return w.z > 0 || c.d.thin ? 1.0f : sqr(c.d.ior); };
      const float forward = bsdf->value(wo, s->wi).f.g / index2(wo), backward = bsdf->value(s->wi, wo).f.g / index2(s->wi);
      ASSERT_NEAR(forward / backward, 1, 5e-3f) << c.name << " " << wo.z << " " << s->wi.z;
      ++pairs;
    }
    EXPECT_GT(pairs, 1500) << c.name;
  }
}

// At normal incidence and exitance every term of the specification is known in closed form.
TEST(GltfMaterial, ValueAtNormalIncidenceIsThatOfTheSpecification) {
  const Vec3f up{0, 0, 1};
  const auto f = [&](const GltfDescription& d) { return make(d)->value(up, up).f; };
  GltfDescription d;
  d.base_color = {0.8f, 0.5f, 0.2f};
  d.roughness = 0.5f;
  const float alpha = 0.25f, shape = kInvPi / sqr(alpha) / 4;  // D / 4 with D = 1 / (pi alpha^2) and G = 1
  d.metallic = 1;
  EXPECT_NEAR(f(d).g, 0.5f * shape, 1e-5f);
  d.metallic = 0;
  // What the interface leaves to the base, with the mean of Schlick's reflectance f0 + (1 - f0) / 21.
  const auto matte = [](float f0, float specular) {
    return sqr(1 - f0 * specular) / (1 - specular * (f0 + (1 - f0) / 21)) * 0.5f * kInvPi;
  };
  EXPECT_NEAR(f(d).g, 0.04f * shape + matte(0.04f, 1), 1e-5f);
  d.ior = 2;
  EXPECT_NEAR(f(d).g, shape / 9 + matte(1.0f / 9, 1), 1e-5f);
  d.specular = 0.5f;
  EXPECT_NEAR(f(d).g, shape / 18 + matte(1.0f / 9, 0.5f), 1e-5f);
  d.metallic = 0.25f;
  EXPECT_NEAR(f(d).g, 0.75f * (shape / 18 + matte(1.0f / 9, 0.5f)) + 0.25f * 0.5f * shape, 1e-5f);
  const float below = f(d).g;
  d.clearcoat = 1;
  d.clearcoat_roughness = 0.5f;
  EXPECT_NEAR(f(d).g, below * 0.96f * 0.96f + 0.04f * shape, 1e-5f);
}

// What a smooth interface does not reflect, the white base gives back: no light is lost, none gained.
TEST(GltfMaterial, WhiteDielectricReflectsEverything) {
  GltfDescription d;
  d.metallic = 0;
  d.roughness = 0.1f;
  for (const float z : {1.0f, 0.6f, 0.2f}) EXPECT_NEAR(sampled_albedo(*make(d), direction(z, 0.4f)).g, 1, 0.01f) << z;
}

TEST(GltfMaterial, MetalAtGrazingAnglesReflectsWhiteBySchlick) {
  GltfDescription d;
  d.base_color = {0.8f, 0.5f, 0.2f};
  d.roughness = 0.4f;
  const Vec3f wo = direction(0.3f, 0), wi = direction(0.3f, kPi);
  const Rgb metal = make(d)->value(wo, wi).f;
  d.base_color = Rgb{1};
  const Rgb white = make(d)->value(wo, wi).f;
  const float weight = std::pow(0.7f, 5.0f);
  EXPECT_NEAR(metal.g / white.g, 0.5f + 0.5f * weight, 1e-5f);
  EXPECT_NEAR(metal.b / white.b, 0.2f + 0.8f * weight, 1e-5f);
}

TEST(GltfMaterial, ThinPaneSendsLightStraightThrough) {
  GltfDescription d;
  d.metallic = 0;
  d.roughness = 0.01f;
  d.transmission = 1;
  const auto pane = make(d);
  const Vec3f wo = direction(0.6f, 0.4f);
  const auto s = pane->sample(wo, 0.9f, {0.3f, 0.6f});
  ASSERT_TRUE(s);
  EXPECT_NEAR(length(s->wi + wo), 0, 5e-3f);
  EXPECT_EQ(s->eta, 1);
  // All that is not reflected, by Schlick from 0.04.
  const float reflected = 0.04f + 0.96f * std::pow(0.4f, 5.0f);
  EXPECT_NEAR(sampled_albedo(*pane, wo).g, 1, 2e-3f);
  EXPECT_NEAR(s->weight.g * (1 - reflected), 1 - reflected, 2e-3f);
}

TEST(GltfMaterial, SheenTableIsTheAlbedoOfSheen) {
  for (const float roughness : {0.3f, 0.6f, 1.0f}) {
    for (const float z : {0.9f, 0.5f, 0.2f}) {
      const Vec3f wo = direction(z, 0);
      std::mt19937 generator(5);
      std::uniform_real_distribution<float> uniform(0, 1);
      double sum = 0;
      constexpr int kSamples = 200000;
      for (int i = 0; i < kSamples; ++i) {
        const Vec3f wi = square_to_cosine_hemisphere({uniform(generator), uniform(generator)});
        if (wi.z <= 0) continue;
        sum += static_cast<double>(kPi * charlie_sheen(charlie_alpha(roughness), z, wi.z, normalize(wo + wi).z)) / kSamples;
      }
      EXPECT_NEAR(CharlieAlbedo::table()(z, roughness), sum, 0.02 * std::max(sum, 0.5)) << roughness << " " << z;
    }
  }
}

}  // namespace
}  // namespace fluxfarm::testing
