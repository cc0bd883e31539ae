// Reciprocity: f(wo, wi) = f(wi, wo) on one side; f(wo, wi) / eta_wo^2 = f(wi, wo) / eta_wi^2 across an interface, because radiance
// scales by the square of the index.
//
// [Veach97] E. Veach, "Robust Monte Carlo Methods for Light Transport Simulation", PhD thesis, 1997, chapter 5.
#include <gtest/gtest.h>

#include <random>

#include "cases.h"

namespace fluxfarm::testing {
namespace {

struct Asymmetry {
  double worst = 0;  // relative difference
  int pairs = 0;     // with a non-zero value
};

// `eta`: interior over exterior index; `power` of it that restores the symmetry (2 is right).
Asymmetry asymmetry(const Bsdf& bsdf, float eta, float power) {
  Asymmetry result;
  std::mt19937 generator(11);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (int i = 0; i < 20000; ++i) {
    const Vec3f wo = direction(1.9f * uniform(generator) - 0.95f, kTwoPi * uniform(generator));
    const auto s = bsdf.sample(wo, uniform(generator), {uniform(generator), uniform(generator)});
    if (!s || s->delta || std::abs(s->wi.z) < 0.02f || std::abs(wo.z) < 0.02f) continue;
    const auto index = [&](Vec3f w) { return w.z > 0 ? 1.0f : std::pow(eta, power); };
    const double forward = bsdf.value(wo, s->wi).f.g / index(wo), backward = bsdf.value(s->wi, wo).f.g / index(s->wi);
    result.worst = std::max(result.worst, std::abs(forward - backward) / std::max(forward, backward));
    ++result.pairs;
  }
  return result;
}

TEST(BsdfReciprocity, HoldsForEveryBsdf) {
  for (const MaterialCase& c : continuous_cases()) {
    if (c.alpha < 0.01f) continue;  // the rounding of the half vector hides everything
    const auto* rough = std::get_if<RoughDielectricDescription>(&c.description);
    const float eta = rough ? rough->dielectric.eta : 1.0f;
    const Asymmetry a = asymmetry(*make(c.description), eta, 2);
    EXPECT_GT(a.pairs, 2000) << c.name;
    EXPECT_LT(a.worst, (rough ? 5e-3 : 1e-5) / c.alpha) << c.name;
  }
}

TEST(BsdfReciprocity, DeltaRefractionScalesBothWays) {
  const auto glass = make(DielectricDescription{});
  const float eta = DielectricDescription{}.eta;
  const auto in = glass->sample(direction(0.8f, 0.3f), 0.99f, {});
  ASSERT_TRUE(in && in->delta);
  EXPECT_LT(in->wi.z, 0);
  EXPECT_NEAR(in->eta, eta, 1e-6);
  EXPECT_NEAR(in->weight.r, 1 / (eta * eta), 1e-6);
  const auto out = glass->sample(in->wi, 0.99f, {});
  ASSERT_TRUE(out);
  EXPECT_NEAR(out->weight.r * in->weight.r, 1, 1e-6);
  EXPECT_NEAR(length(out->wi - direction(0.8f, 0.3f)), 0, 1e-6);
}

// Twins: without the square, or with it twice, the check is red.
TEST(BsdfReciprocityTwin, WrongPowerOfEtaIsRejected) {
  const auto ground = make(RoughDielectricDescription{{}, ggx(0.3f)});
  EXPECT_GT(asymmetry(*ground, DielectricDescription{}.eta, 0).worst, 0.3);
  EXPECT_GT(asymmetry(*ground, DielectricDescription{}.eta, 4).worst, 0.3);
}

}  // namespace
}  // namespace fluxfarm::testing
