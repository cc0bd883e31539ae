// Corners: grazing and horizontal directions, tiny roughness, equal indices, the ends of the sample square. Never NaN, never
// infinity.
#include <gtest/gtest.h>

#include "cases.h"
#include "support/error.h"

namespace fluxfarm::testing {
namespace {

std::vector<MaterialCase> corner_cases() {
  std::vector<MaterialCase> cases = continuous_cases();
  DielectricDescription air;
  air.eta = 1;
  DielectricDescription nearly_air;
  nearly_air.eta = 1.0002f;
  DielectricDescription bubble;
  bubble.eta = 1 / 1.33f;
  PlasticDescription thin = painted_plastic();
  thin.eta = 1;
  PlasticDescription black;
  black.diffuse_reflectance = black.specular_reflectance = Rgb{0};
  ConductorDescription nothing;
  nothing.k = Rgb{0};
  cases.insert(cases.end(), {{"mirror", perfect_mirror()},
                             {"gold", gold()},
                             {"no_metal", nothing},
                             {"glass", DielectricDescription{}},
                             {"air", air},
                             {"bubble", bubble},
                             {"thin_plastic", thin},
                             {"black_plastic", black}});
  for (const Roughness& r : {beckmann(1e-4f), ggx(1e-4f), beckmann(1e-7f), ggx(1e-7f), beckmann(1.5f), ggx(1.5f), ggx(0.2f)}) {
    cases.push_back({"rough_gold", RoughConductorDescription{gold(), r}});
    cases.push_back({"rough_nothing", RoughConductorDescription{nothing, r}});
    cases.push_back({"rough_glass", RoughDielectricDescription{{}, r}});
    cases.push_back({"rough_air", RoughDielectricDescription{air, r}});
    cases.push_back({"rough_nearly_air", RoughDielectricDescription{nearly_air, r}});
    cases.push_back({"rough_bubble", RoughDielectricDescription{bubble, r}});
    cases.push_back({"rough_plastic", RoughPlasticDescription{painted_plastic(), r}});
    cases.push_back({"rough_thin_plastic", RoughPlasticDescription{thin, r}});
    cases.push_back({"rough_black_plastic", RoughPlasticDescription{black, r}});
  }
  return cases;
}

std::vector<Vec3f> corner_directions() {
  std::vector<Vec3f> directions{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}, {1, 0, -0.0f}};
  for (const float z : {1e-30f, 1e-10f, 1e-6f, 1e-4f, 1e-3f, 0.01f, 0.3f, 0.745f, 0.9f, 0.99999f}) {
    for (const float phi : {0.0f, 1.0f, 3.14159265f, 4.5f}) {
      directions.push_back(direction(z, phi));
      directions.push_back(direction(-z, phi));
    }
  }
  return directions;
}

TEST(BsdfRobustness, ValuesAreFiniteAndNotNegative) {
  const std::vector<Vec3f> directions = corner_directions();
  for (const MaterialCase& c : corner_cases()) {
    const auto bsdf = make(c.description);
    for (const Vec3f wo : directions) {
      const Rgb a = bsdf->albedo(wo);
      ASSERT_TRUE(is_finite(a) && a.r >= 0 && a.g >= 0 && a.b >= 0) << c.name << " wo.z " << wo.z;
      for (const Vec3f wi : directions) {
        const BsdfValue v = bsdf->value(wo, wi);
        ASSERT_TRUE(is_finite(v.f) && std::isfinite(v.pdf)) << c.name << " wo.z " << wo.z << " wi.z " << wi.z;
        ASSERT_TRUE(v.pdf >= 0 && v.f.r >= 0 && v.f.g >= 0 && v.f.b >= 0) << c.name;
      }
    }
  }
}

TEST(BsdfRobustness, SamplesAreFiniteUnitAndHaveAPdf) {
  const float ends[] = {0.0f, 1e-7f, 0.25f, 0.5f, 0.7f, 1 - 0x1p-24f};
  for (const MaterialCase& c : corner_cases()) {
    const auto bsdf = make(c.description);
    for (const Vec3f wo : corner_directions()) {
      for (const float u_lobe : ends) {
        for (const float u_x : ends) {
          for (const float u_y : ends) {
            const auto s = bsdf->sample(wo, u_lobe, {u_x, u_y});
            if (!s) continue;
            ASSERT_TRUE(is_finite(s->weight) && std::isfinite(s->pdf) && is_finite(s->wi)) << c.name << " wo.z " << wo.z;
            ASSERT_NEAR(length(s->wi), 1, 1e-5) << c.name << " wo.z " << wo.z;
            ASSERT_EQ(s->delta, s->pdf == 0) << c.name;
            ASSERT_GE(std::min({s->weight.r, s->weight.g, s->weight.b}), 0) << c.name;
            ASSERT_LE(max_component(s->weight) * sqr(s->eta), 20) << c.name << " wo.z " << wo.z;
          }
        }
      }
    }
  }
}

TEST(BsdfSides, OneSidedMaterialsAreBlackBehind) {
  for (const MaterialCase& c : corner_cases()) {
    const auto bsdf = make(c.description);
    if (bsdf->transmits()) continue;
    const Vec3f behind = direction(-0.6f, 1), front = direction(0.7f, 2);
    EXPECT_FALSE(bsdf->sample(behind, 0.3f, {0.4f, 0.6f})) << c.name;
    EXPECT_TRUE(bsdf->value(behind, direction(-0.5f, 2)).f.is_black()) << c.name;
    EXPECT_TRUE(bsdf->value(front, behind).f.is_black()) << c.name;
    EXPECT_TRUE(bsdf->albedo(behind).is_black()) << c.name;
  }
}

TEST(BsdfSides, TwosidedMirrorsItsSides) {
  const auto bsdfs = make_bsdfs({DiffuseDescription{Rgb{0.2f}}, TwosidedDescription{0, 2}, DiffuseDescription{Rgb{0.8f}}});
  EXPECT_FLOAT_EQ(bsdfs[1]->value(direction(0.5f, 1), direction(0.4f, 2)).f.r, 0.2f * kInvPi);
  EXPECT_FLOAT_EQ(bsdfs[1]->value(direction(-0.5f, 1), direction(-0.4f, 2)).f.r, 0.8f * kInvPi);
  EXPECT_TRUE(bsdfs[1]->value(direction(-0.5f, 1), direction(0.4f, 2)).f.is_black());
  EXPECT_LT(bsdfs[1]->sample(direction(-0.5f, 1), 0.5f, {0.3f, 0.3f})->wi.z, 0);
}

TEST(BsdfDeltas, ProbabilitiesAreFresnels) {
  const auto glass = make(DielectricDescription{});
  // Normal incidence: ((eta - 1) / (eta + 1))^2.
  const float eta = DielectricDescription{}.eta, f = sqr((eta - 1) / (eta + 1));
  EXPECT_GT(glass->sample({0, 0, 1}, f * 0.999f, {})->wi.z, 0);
  EXPECT_LT(glass->sample({0, 0, 1}, f * 1.001f, {})->wi.z, 0);
  // Beyond the critical angle everything is reflected.
  const auto inside = glass->sample(direction(-0.5f, 1), 0.9999f, {});
  EXPECT_LT(inside->wi.z, 0);
  EXPECT_EQ(inside->eta, 1);
  EXPECT_FALSE(glass->has_continuous_lobe());
  EXPECT_TRUE(glass->transmits());
}

TEST(BsdfDeltas, EqualIndicesLetLightThroughStraight) {
  DielectricDescription air;
  air.eta = 1;
  for (const MaterialDescription& d : {MaterialDescription{air}, MaterialDescription{RoughDielectricDescription{air, ggx(0.3f)}}}) {
    const auto s = make(d)->sample(direction(0.3f, 1), 0.0f, {0.5f, 0.5f});
    ASSERT_TRUE(s && s->delta);
    EXPECT_NEAR(length(s->wi + direction(0.3f, 1)), 0, 1e-6);
    EXPECT_EQ(s->weight.r, 1);
  }
}

TEST(MakeBsdfs, RefusesTwosidedSidesThatMakeNoSense) {
  EXPECT_THROW(make_bsdfs({TwosidedDescription{1, 0}}), SceneError);
  EXPECT_THROW(make_bsdfs({TwosidedDescription{0, 0}}), SceneError);
  EXPECT_THROW(make_bsdfs({TwosidedDescription{1, 1}, DielectricDescription{}}), SceneError);
  EXPECT_EQ(make_bsdfs({}).size(), 0u);
}

}  // namespace
}  // namespace fluxfarm::testing
