// sample() against pdf(): chi-square, integral of the density, and weight = f |cos| / pdf. With twins that must fail.
#include <gtest/gtest.h>

#include "cases.h"
#include "materials/directions.h"
#include "materials/fresnel.h"
#include "support/chi_square.h"

namespace fluxfarm::testing {
namespace {

// All chi-square tests of this file together reject correct code with this probability; the seeds are fixed.
constexpr double kOverallLevel = 0.01;
constexpr float kCosines[] = {1.0f, 0.6f, 0.08f, -0.5f};

enum class Part { kAll, kReflected, kTransmitted };

bool in_part(Part part, const Vec3f& wo, const Vec3f& wi) {
  return part == Part::kAll || (wo.z * wi.z > 0) == (part == Part::kReflected);
}

// Where a narrow lobe sits, and how narrow: the cells are gathered there.
SphereChart chart_for(const MaterialCase& c, Vec3f wo, Part part) {
  if (c.alpha > 0.1f) return {};
  const double power = c.alpha > 0.01f ? 2.5 : 6;
  if (part != Part::kTransmitted) return {reflect(wo), power};
  const float eta = std::get<RoughDielectricDescription>(c.description).dielectric.eta;
  const DielectricFresnel f = fresnel_dielectric(wo.z, eta);
  if (f.reflectance == 1) return {};  // total reflection: only the tails of the distribution get through, widely
  return {refract(wo, {0, 0, 1}, wo.z, f.cos_t, f.eta), power};
}

ChiSquareResult test_bsdf(const Bsdf& bsdf, Vec3f wo, const SphereChart& chart, Part part = Part::kAll) {
  ChiSquareSettings settings;
  settings.chart = chart;
  return chi_square(
      settings,
      [&](float u_lobe, Vec2f u) -> std::optional<Vec3f> {
        const auto s = bsdf.sample(wo, u_lobe, u);
        if (!s || s->delta || !in_part(part, wo, s->wi)) return std::nullopt;
        return s->wi;
      },
      [&](Vec3f wi) -> double { return in_part(part, wo, wi) ? bsdf.pdf(wo, wi) : 0; });
}

struct LobeCase {
  MaterialCase material;
  Part part;
};

std::vector<LobeCase> lobe_cases() {
  std::vector<LobeCase> lobes;
  for (const MaterialCase& c : continuous_cases()) {
    const bool split = c.alpha <= 0.1f && std::holds_alternative<RoughDielectricDescription>(c.description);
    if (split) {
      lobes.push_back({c, Part::kReflected});
      lobes.push_back({c, Part::kTransmitted});
    } else {
      lobes.push_back({c, Part::kAll});
    }
  }
  return lobes;
}

// The integral of the density must be the probability that sample() gives a continuous direction: samples that the microfacets send
// below the horizon, and delta lobes, are missing from both.
TEST(BsdfSampling, SamplesFollowThePdfWhichIntegratesToTheProbabilityOfASample) {
  const std::vector<LobeCase> lobes = lobe_cases();
  const int tests = static_cast<int>(lobes.size() * std::size(kCosines));
  for (const LobeCase& lobe : lobes) {
    const auto bsdf = make(lobe.material.description);
    for (const float z : kCosines) {
      SCOPED_TRACE(lobe.material.name + " at cosine " + std::to_string(z) + " part " + std::to_string(static_cast<int>(lobe.part)));
      const Vec3f wo = direction(z, 0.4f);
      const ChiSquareResult r = test_bsdf(*bsdf, wo, chart_for(lobe.material, wo, lobe.part), lobe.part);
      EXPECT_GT(r.p_value, sidak_level(kOverallLevel, tests));
      // Five standard deviations of the fraction, and 2e-3 for the quadrature at the horizon.
      EXPECT_NEAR(r.integral, r.success_fraction, 5 * std::sqrt(0.25 / 200000) + 2e-3);
    }
  }
}

TEST(BsdfSampling, TwosidedSamplesFollowThePdfOnBothSides) {
  const auto bsdfs = make_bsdfs({TwosidedDescription{1, 2}, DiffuseDescription{}, RoughConductorDescription{gold(), ggx(0.4f)}});
  for (const float z : kCosines) {
    const ChiSquareResult r = test_bsdf(*bsdfs[0], direction(z, 0.4f), {});
    EXPECT_GT(r.p_value, sidak_level(kOverallLevel, 4)) << z;
    EXPECT_GT(r.integral, 0.8) << z;
  }
}

TEST(BsdfSampling, WeightIsValueTimesCosineOverPdf) {
  for (const MaterialCase& c : continuous_cases()) {
    // Single precision resolves the half vector of a narrow lobe to 1e-7 / alpha.
    const float tolerance = std::max(1e-4f, 1e-5f / c.alpha);
    const auto bsdf = make(c.description);
    std::mt19937 generator(7);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (int i = 0; i < 5000; ++i) {
      const Vec3f wo = direction(2 * uniform(generator) - 1, kTwoPi * uniform(generator));
      const auto s = bsdf->sample(wo, uniform(generator), {uniform(generator), uniform(generator)});
      if (!s || s->delta) continue;
      ASSERT_NEAR(length(s->wi), 1, 2e-6) << c.name;
      const BsdfValue v = bsdf->value(wo, s->wi);
      ASSERT_GT(s->pdf, 0) << c.name;
      if (std::abs(s->wi.z) < 1e-3f || std::abs(wo.z) < 1e-3f) continue;
      // Refraction near grazing microfacets magnifies the rounding of the half vector.
      const float spread = s->eta == 1 ? 1.0f : 20.0f;
      ASSERT_NEAR(v.pdf / s->pdf, 1, spread * tolerance * 10) << c.name << " wo.z " << wo.z << " wi.z " << s->wi.z;
      const Rgb weight = v.f * (std::abs(s->wi.z) / v.pdf);
      ASSERT_NEAR(weight.r / s->weight.r, 1, spread * tolerance) << c.name << " wo.z " << wo.z << " wi.z " << s->wi.z;
      ASSERT_NEAR(weight.b / s->weight.b, 1, spread * tolerance) << c.name;
    }
  }
}

// ---- Twins: each breaks one thing, and the test must turn red. ----

class Twin : public Bsdf {
 public:
  explicit Twin(const MaterialDescription& d) : inner_(make(d)) {}
  BsdfValue value(const Vec3f& wo, const Vec3f& wi) const override { return inner_->value(wo, wi); }
  std::optional<BsdfSample> sample(const Vec3f& wo, float u_lobe, Vec2f u) const override { return inner_->sample(wo, u_lobe, u); }
  Rgb albedo(const Vec3f& wo) const override { return inner_->albedo(wo); }
  bool has_continuous_lobe() const override { return true; }

 private:
  std::unique_ptr<Bsdf> inner_;
};

class PdfWithoutCosine final : public Twin {
 public:
  using Twin::Twin;
  BsdfValue value(const Vec3f& wo, const Vec3f& wi) const override {
    BsdfValue v = Twin::value(wo, wi);
    if (v.pdf > 0) v.pdf = 0.5f * kInvPi;
    return v;
  }
};

class LosesOnePercent final : public Twin {
 public:
  using Twin::Twin;
  std::optional<BsdfSample> sample(const Vec3f& wo, float u_lobe, Vec2f u) const override {
    if (u_lobe > 0.99f) return std::nullopt;
    return Twin::sample(wo, u_lobe, u);
  }
};

class TurnedByTwoDegrees final : public Twin {
 public:
  using Twin::Twin;
  std::optional<BsdfSample> sample(const Vec3f& wo, float u_lobe, Vec2f u) const override {
    auto s = Twin::sample(wo, u_lobe, u);
    if (s) s->wi = {s->wi.x - 0.035f * s->wi.y, s->wi.y + 0.035f * s->wi.x, s->wi.z};
    return s;
  }
};

TEST(BsdfSamplingTwin, PdfWithoutItsCosineIsRejected) {
  EXPECT_LT(test_bsdf(PdfWithoutCosine(DiffuseDescription{}), direction(0.6f, 0.4f), {}).p_value, 1e-12);
}

TEST(BsdfSamplingTwin, SamplerThatLosesOnePercentIsRejected) {
  EXPECT_LT(test_bsdf(LosesOnePercent(DiffuseDescription{}), direction(0.6f, 0.4f), {}).p_value, 1e-12);
}

TEST(BsdfSamplingTwin, LobeTurnedByTwoDegreesIsRejected) {
  const TurnedByTwoDegrees twin(RoughConductorDescription{gold(), ggx(0.3f)});
  EXPECT_LT(test_bsdf(twin, direction(0.6f, 0.4f), {}).p_value, 1e-12);
}

// The density of visible normals belongs to its own distribution.
TEST(BsdfSamplingTwin, BeckmannSamplesWithGgxPdfAreRejected) {
  const auto samples = make(RoughConductorDescription{gold(), beckmann(0.3f)});
  const auto density = make(RoughConductorDescription{gold(), ggx(0.3f)});
  const Vec3f wo = direction(0.6f, 0.4f);
  const ChiSquareResult r = chi_square(
      {},
      [&](float u_lobe, Vec2f u) -> std::optional<Vec3f> {
        const auto s = samples->sample(wo, u_lobe, u);
        return s ? std::optional(s->wi) : std::nullopt;
      },
      [&](Vec3f wi) -> double { return density->pdf(wo, wi); });
  EXPECT_LT(r.p_value, 1e-12);
}

TEST(ChiSquare, PValuesOfAKnownDistributionAreRight) {
  // Tables of the chi-square distribution: upper 5 % and 1 % points.
  EXPECT_NEAR(upper_incomplete_gamma(0.5, 3.841459 / 2), 0.05, 1e-6);
  EXPECT_NEAR(upper_incomplete_gamma(5, 18.307038 / 2), 0.05, 1e-6);
  EXPECT_NEAR(upper_incomplete_gamma(50, 135.806723 / 2), 0.01, 1e-6);
}

}  // namespace
}  // namespace fluxfarm::testing
