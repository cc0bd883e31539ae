// The principled BSDF: values against Mitsuba's, sampling against its density, reciprocity, energy, textures; with twins.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "materials/directions.h"
#include "materials/fresnel.h"
#include "materials/make_textured.h"
#include "principled_cases.h"
#include "support/chi_square.h"

namespace fluxfarm::testing {
namespace {

constexpr double kOverallLevel = 0.01;  // of all chi-square tests of this file together
constexpr float kCosines[] = {1.0f, 0.6f, 0.08f, -0.5f};

struct Row {
  std::string name;
  float wo[2], wi[2];  // cosine and azimuth
  float f[3];          // sr^-1
};

const std::vector<Row> kRows = {
#include "mitsuba_principled.inc"
};

MaterialCase named(const std::string& name) {
  const auto cases = principled_cases();
  return *std::find_if(cases.begin(), cases.end(), [&](const MaterialCase& c) { return c.name == name; });
}

// Largest relative difference to a row.
double difference(const Bsdf& bsdf, const Row& row) {
  const Rgb f = bsdf.value(direction(row.wo[0], row.wo[1]), direction(row.wi[0], row.wi[1])).f;
  double worst = 0;
  for (const auto& [ours, theirs] : {std::pair{f.r, row.f[0]}, {f.g, row.f[1]}, {f.b, row.f[2]}}) {
    worst = std::max(worst, std::abs(static_cast<double>(ours) - theirs) / std::max(1e-6, static_cast<double>(theirs)));
  }
  return worst;
}

// 5e-4: single precision, and Mitsuba's luminance has other last digits.
TEST(Principled, ValuesAreMitsubas) {
  for (const Row& row : kRows) {
    const auto bsdf = make(named(row.name).description);
    EXPECT_LT(difference(*bsdf, row), 5e-4) << row.name << " wo.z " << row.wo[0] << " wi.z " << row.wi[0];
  }
}

TEST(PrincipledTwin, AParameterOffByAHundredthIsNoticed) {
  using D = PrincipledDescription;
  const auto noticed = [](const std::string& name, auto&& change) {
    auto d = std::get<D>(named(name).description);
    change(d);
    const auto bsdf = make(d);
    double worst = 0;
    for (const Row& row : kRows) {
      if (row.name == name) worst = std::max(worst, difference(*bsdf, row));
    }
    return worst > 5e-4;
  };
  EXPECT_FALSE(noticed("all", [](D&) {}));
  EXPECT_TRUE(noticed("all", [](D& d) { d.roughness.factor += 0.01f; }));
  EXPECT_TRUE(noticed("all", [](D& d) { d.metallic.factor += 0.01f; }));
  EXPECT_TRUE(noticed("all", [](D& d) { d.spec_trans.factor += 0.01f; }));
  EXPECT_TRUE(noticed("all", [](D& d) { d.spec_tint.factor += 0.01f; }));
  EXPECT_TRUE(noticed("all", [](D& d) { d.anisotropic.factor += 0.01f; }));
  EXPECT_TRUE(noticed("all", [](D& d) { d.clearcoat.factor += 0.01f; }));
  EXPECT_TRUE(noticed("all", [](D& d) { d.clearcoat_gloss.factor += 0.01f; }));
  EXPECT_TRUE(noticed("all", [](D& d) { d.eta += 0.01f; }));
  EXPECT_TRUE(noticed("flat", [](D& d) { d.flatness.factor += 0.01f; }));
  EXPECT_TRUE(noticed("cloth", [](D& d) { d.sheen.factor += 0.01f; }));
  EXPECT_TRUE(noticed("cloth", [](D& d) { d.sheen_tint.factor += 0.01f; }));
}

// Where the narrowest lobe sits: the cells are gathered there.
SphereChart chart_for(const MaterialCase& c, Vec3f wo) {
  if (c.name == "metal") return {reflect(wo), 2};
  if (c.name != "half_glass") return {};
  const float eta = std::get<PrincipledDescription>(c.description).eta;
  const DielectricFresnel f = fresnel_dielectric(wo.z, eta);
  return {f.reflectance == 1 ? reflect(wo) : refract(wo, {0, 0, 1}, wo.z, f.cos_t, f.eta), 2};
}

ChiSquareResult test_sampling(const Bsdf& samples, const Bsdf& density, Vec3f wo, const SphereChart& chart = {}) {
  ChiSquareSettings settings;
  settings.chart = chart;
  settings.samples = 100000;
  return chi_square(
      settings,
      [&](float u_lobe, Vec2f u) -> std::optional<Vec3f> {
        const auto s = samples.sample(wo, u_lobe, u);
        return s ? std::optional(s->wi) : std::nullopt;
      },
      [&](Vec3f wi) -> double { return density.pdf(wo, wi); });
}

TEST(Principled, SamplesFollowThePdfWhichIntegratesToTheProbabilityOfASample) {
  const auto cases = principled_cases();
  for (const MaterialCase& c : cases) {
    const auto bsdf = make(c.description);
    for (const float z : kCosines) {
      SCOPED_TRACE(c.name + " at cosine " + std::to_string(z));
      const ChiSquareResult r = test_sampling(*bsdf, *bsdf, direction(z, 0.4f), chart_for(c, direction(z, 0.4f)));
      EXPECT_GT(r.p_value, sidak_level(kOverallLevel, static_cast<int>(cases.size() * std::size(kCosines))));
      EXPECT_NEAR(r.integral, r.success_fraction, 5 * std::sqrt(0.25 / 100000) + 2e-3);
    }
  }
}

// Twins: the density of a neighbouring roughness, or of another mixture of lobes.
TEST(PrincipledTwin, DensitiesOfNeighboursAreRejected) {
  auto rougher = std::get<PrincipledDescription>(named("metal").description);
  rougher.roughness.factor = 0.32f;
  const Vec3f wo = direction(0.6f, 0.4f);
  EXPECT_LT(test_sampling(*make(named("metal").description), *make(rougher), wo).p_value, 1e-12);
  EXPECT_LT(test_sampling(*make(named("coat").description), *make(named("plain").description), wo).p_value, 1e-12);
  auto clearer = std::get<PrincipledDescription>(named("half_glass").description);
  clearer.spec_trans.factor = 0.55f;
  EXPECT_LT(test_sampling(*make(named("half_glass").description), *make(clearer), wo).p_value, 1e-12);
}

// f(wo, wi) / eta_wo^power = f(wi, wo) / eta_wi^power; the power is 2 for radiance.
double worst_asymmetry(const MaterialCase& c, float power) {
  const auto& d = std::get<PrincipledDescription>(c.description);
  const auto bsdf = make(d);
  std::mt19937 generator(11);
  std::uniform_real_distribution<float> uniform(0, 1);
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3f wo = direction(1.9f * uniform(generator) - 0.95f, kTwoPi * uniform(generator));
    const auto s = bsdf->sample(wo, uniform(generator), {uniform(generator), uniform(generator)});
    if (!s || std::abs(s->wi.z) < 0.02f || std::abs(wo.z) < 0.02f) continue;
    const auto index = [&](Vec3f w) { return w.z > 0 ? 1.0f : std::pow(d.eta, power); };
    const double forward = bsdf->value(wo, s->wi).f.g / index(wo), backward = bsdf->value(s->wi, wo).f.g / index(s->wi);
    worst = std::max(worst, std::abs(forward - backward) / std::max(forward, backward));
  }
  return worst;
}

TEST(Principled, IsReciprocal) {
  for (const MaterialCase& c : principled_cases()) {
    const bool transmits = std::get<PrincipledDescription>(c.description).spec_trans.factor > 0;
    EXPECT_LT(worst_asymmetry(c, 2), (transmits ? 5e-3 : 1e-5) / c.alpha) << c.name;
  }
  EXPECT_GT(worst_asymmetry(named("glass"), 0), 0.3) << "twin: without the square";
}

// Mean weight of samples; refracted light as flux.
Rgb sampled_albedo(const Bsdf& bsdf, Vec3f wo) {
  constexpr int kStrata = 200;
  std::mt19937 generator(3);
  std::uniform_real_distribution<float> uniform(0, 1);
  double sum[3] = {};
  for (int i = 0; i < kStrata * kStrata; ++i) {
    const Vec2f u{(static_cast<float>(i % kStrata) + uniform(generator)) / kStrata * 0.9999999f,
                  (static_cast<float>(i / kStrata) + uniform(generator)) / kStrata * 0.9999999f};
    const auto s = bsdf.sample(wo, uniform(generator), u);
    if (!s) continue;
    const Rgb w = s->weight * sqr(s->eta);
    sum[0] += w.r, sum[1] += w.g, sum[2] += w.b;
  }
  const auto mean_of = [](double v) { return static_cast<float>(v / (kStrata * kStrata)); };
  return {mean_of(sum[0]), mean_of(sum[1]), mean_of(sum[2])};
}

TEST(PrincipledEnergy, AlbedoIsTheDirectionalAlbedoWithinItsStatedAccuracy) {
  for (const MaterialCase& c : principled_cases()) {
    if (std::get<PrincipledDescription>(c.description).anisotropic.factor > 0) continue;  // averaged over the azimuth, as stated
    const auto bsdf = make(c.description);
    for (const float z : {1.0f, 0.7f, 0.3f, -0.5f}) {
      const Vec3f wo = direction(z, 0.4f);
      EXPECT_NEAR(bsdf->albedo(wo).r, sampled_albedo(*bsdf, wo).r, 0.02) << c.name << " wo.z " << z;
      EXPECT_NEAR(bsdf->albedo(wo).b, sampled_albedo(*bsdf, wo).b, 0.02) << c.name << " wo.z " << z;
    }
  }
}

// The metal and the glass keep to their light.
TEST(PrincipledEnergy, MicrofacetLobesGainNothing) {
  for (const float roughness : {0.1f, 0.4f, 0.7f, 1.0f}) {
    for (const bool glass : {false, true}) {
      PrincipledDescription d;
      d.base_color = Rgb{1.0f};
      d.roughness = {roughness};
      (glass ? d.spec_trans : d.metallic) = {1};
      const auto bsdf = make(d);
      for (const float z : {0.95f, 0.5f, 0.15f, -0.5f}) {
        EXPECT_LE(max_component(sampled_albedo(*bsdf, direction(z, 0.4f))), 1.004f) << glass << " " << roughness << " " << z;
      }
    }
  }
}

TEST(PrincipledEnergy, TheDiffusePartOfAWhiteOneGainsWhatIsStated) {
  const auto albedo = [](float roughness, float z) {
    PrincipledDescription d;
    d.base_color = Rgb{1.0f};
    d.roughness = {roughness};
    return sampled_albedo(*make(d), direction(z, 0.4f)).g;
  };
  EXPECT_NEAR(albedo(0.5f, 1.0f), 1.043f, 0.01);
  EXPECT_NEAR(albedo(0.5f, 0.5f), 1.076f, 0.01);
  EXPECT_NEAR(albedo(0.5f, 0.1f), 1.181f, 0.01);
  EXPECT_NEAR(albedo(1.0f, 1.0f), 1.048f, 0.01);
  EXPECT_NEAR(albedo(1.0f, 0.1f), 1.419f, 0.01);
}

TEST(Principled, ParametersMayBeTextures) {
  // The value of each texture at (0.1, 0.1) and at (0.9, 0.1).
  const auto halves = [](Rgb left, Rgb right) { return CheckerboardDescription{left, right, Transform::scale(1, 0, 1)}; };
  const Textures textures =
      make_textures({halves({0.8f, 0.4f, 0.1f}, {0.1f, 0.4f, 0.9f}), halves(Rgb{0.3f}, Rgb{0.7f}), halves(Rgb{1}, Rgb{0})});
  PrincipledDescription d;
  d.base_color = Rgb{1};
  d.base_color_texture = 0;
  d.roughness = {1, 1};
  d.metallic = {1, 2};
  const auto bsdfs = make_bsdfs({d});
  const auto materials = make_textured_materials({d}, bsdfs, textures);
  const auto expected = [](Rgb colour, float roughness, float metallic) {
    PrincipledDescription constant;
    constant.base_color = colour;
    constant.roughness = {roughness};
    constant.metallic = {metallic};
    return make(constant);
  };
  BsdfSpace space;
  for (const bool left : {true, false}) {
    const Bsdf& there = materials.at(0)->at({.texture = {.uv = {left ? 0.1f : 0.9f, 0.1f}}}, space);
    const auto constant = left ? expected({0.8f, 0.4f, 0.1f}, 0.3f, 1) : expected({0.1f, 0.4f, 0.9f}, 0.7f, 0);
    const Vec3f wo = direction(0.7f, 0.2f), wi = direction(0.6f, 3.0f);
    EXPECT_NEAR(there.value(wo, wi).f.r, constant->value(wo, wi).f.r, 1e-5);
    EXPECT_NEAR(there.value(wo, wi).pdf, constant->value(wo, wi).pdf, 1e-5);
    EXPECT_NEAR(there.albedo(wo).g, constant->albedo(wo).g, 0.15);
  }
}

TEST(Principled, RefusesNothingAtTheEnds) {
  const float ends[] = {0.0f, 1e-7f, 0.5f, 1 - 0x1p-24f};
  for (const float value : {0.0f, 1.0f}) {
    for (const float eta : {1.0f, 1.0002f, 0.5f, 3.0f}) {
      for (const float trans : {0.0f, 1.0f}) {
        PrincipledDescription d;
        d.base_color = Rgb{value};
        d.roughness = {value};
        d.anisotropic = d.spec_tint = d.sheen = d.sheen_tint = d.flatness = d.clearcoat = d.clearcoat_gloss = {value};
        d.spec_trans = {trans};
        d.eta = eta;
        const auto bsdf = make(d);
        for (const float z : {1.0f, 0.5f, 1e-3f, 1e-10f, 0.0f, -1e-3f, -1.0f}) {
          const Vec3f wo = direction(z, 1);
          ASSERT_TRUE(is_finite(bsdf->albedo(wo)));
          for (const float u_lobe : ends) {
            for (const float u : ends) {
              const auto s = bsdf->sample(wo, u_lobe, {u, 1 - u * 0.9999999f - 0x1p-24f});
              if (!s) continue;
              ASSERT_TRUE(is_finite(s->weight) && std::isfinite(s->pdf) && s->pdf > 0) << z;
              ASSERT_NEAR(length(s->wi), 1, 1e-4);
            }
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace fluxfarm::testing
