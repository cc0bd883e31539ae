// Materials that hold others, or let light straight through: mask, null, blend, thin dielectric, normal and bump maps. With twins.
#include <gtest/gtest.h>

#include "cases.h"
#include "materials/directions.h"
#include "materials/fresnel.h"
#include "materials/make_textured.h"
#include "materials/perturbed.h"
#include "support/chi_square.h"
#include "support/error.h"

namespace fluxfarm::testing {
namespace {

constexpr double kLevel = 1e-4;  // of one chi-square test; a dozen of them with fixed seeds

// The first of some materials with all that it borrows, at a hit.
class AtHit {
 public:
  explicit AtHit(std::vector<MaterialDescription> materials, const std::vector<TextureDescription>& textures = {})
      : textures_(make_textures(textures)),
        bsdfs_(make_bsdfs(materials)),
        textured_(make_textured_materials(materials, bsdfs_, textures_)) {}

  const Bsdf& constant() const { return *bsdfs_[0]; }
  bool has_texture() const { return textured_[0] != nullptr; }
  const Bsdf& at(const MaterialPoint& point) { return textured_[0]->at(point, space_); }

 private:
  Textures textures_;
  std::vector<std::unique_ptr<Bsdf>> bsdfs_;
  std::vector<std::unique_ptr<TexturedMaterial>> textured_;
  BsdfSpace space_;
};

ChiSquareResult test_sampling(const Bsdf& samples, const Bsdf& density, Vec3f wo) {
  ChiSquareSettings settings;
  settings.samples = 100000;
  return chi_square(
      settings,
      [&](float u_lobe, Vec2f u) -> std::optional<Vec3f> {
        const auto s = samples.sample(wo, u_lobe, u);
        return s && !s->delta ? std::optional(s->wi) : std::nullopt;
      },
      [&](Vec3f wi) -> double { return density.pdf(wo, wi); });
}

void expect_samples_follow(const Bsdf& bsdf, const std::string& name) {
  for (const float z : {0.9f, 0.4f, -0.6f}) {
    const ChiSquareResult r = test_sampling(bsdf, bsdf, direction(z, 0.4f));
    EXPECT_GT(r.p_value, kLevel) << name << " at cosine " << z;
    EXPECT_NEAR(r.integral, r.success_fraction, 5 * std::sqrt(0.25 / 100000) + 2e-3) << name << " at cosine " << z;
  }
}

// Mean weight times cosine-free f: the weight must be f |cos| / pdf.
void expect_weights_are_right(const Bsdf& bsdf) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (int i = 0; i < 2000; ++i) {
    const Vec3f wo = direction(2 * uniform(generator) - 1, kTwoPi * uniform(generator));
    const auto s = bsdf.sample(wo, uniform(generator), {uniform(generator), uniform(generator)});
    if (!s || s->delta || std::abs(s->wi.z) < 1e-2f || std::abs(wo.z) < 1e-2f) continue;
    const BsdfValue v = bsdf.value(wo, s->wi);
    ASSERT_NEAR(v.pdf / s->pdf, 1, 2e-3);
    ASSERT_NEAR(v.f.r * std::abs(s->wi.z) / v.pdf / s->weight.r, 1, 2e-3);
  }
}

const MaterialDescription kRed = DiffuseDescription{{0.8f, 0.2f, 0.1f}};
const MaterialDescription kMetal = RoughConductorDescription{gold(), ggx(0.4f)};
const MaterialDescription kGround = RoughDielectricDescription{{}, ggx(0.4f)};
// 0.25 where u is below a half, 0.75 above it.
TextureDescription quarters() { return CheckerboardDescription{Rgb{0.25f}, Rgb{0.75f}, Transform::scale(1, 0, 1)}; }
MaterialPoint place(float u) { return {.texture = {.uv = {u, 0.1f}}}; }

TEST(Null, LetsAllLightPass) {
  const auto bsdf = make(NullDescription{});
  for (const float z : {1.0f, 0.3f, -0.2f}) {
    const auto s = bsdf->sample(direction(z, 2), 0.5f, {0.3f, 0.6f});
    ASSERT_TRUE(s && s->delta);
    EXPECT_EQ(s->wi, -direction(z, 2));
    EXPECT_EQ(s->weight, Rgb{1.0f});
    EXPECT_EQ(s->eta, 1);
  }
  EXPECT_FALSE(bsdf->has_continuous_lobe());
  EXPECT_TRUE(bsdf->transmits());
}

TEST(Mask, ScattersItsShareAndLetsTheRestPass) {
  AtHit mask({MaskDescription{1, {0.3f}}, kMetal});
  const auto metal = make(kMetal);
  const Vec3f wo = direction(0.6f, 0.4f), wi = direction(0.5f, 3.3f);
  EXPECT_FALSE(mask.has_texture());
  EXPECT_FLOAT_EQ(mask.constant().value(wo, wi).f.r, 0.3f * metal->value(wo, wi).f.r);
  EXPECT_FLOAT_EQ(mask.constant().value(wo, wi).pdf, 0.3f * metal->value(wo, wi).pdf);
  const auto passing = mask.constant().sample(wo, 0.31f, {0.2f, 0.2f});
  ASSERT_TRUE(passing && passing->delta);
  EXPECT_EQ(passing->wi, -wo);
  EXPECT_EQ(passing->weight, Rgb{1.0f});
  EXPECT_FALSE(mask.constant().sample(wo, 0.29f, {0.2f, 0.2f})->delta);
  EXPECT_NEAR(mask.constant().albedo(wo).g, 0.3f * metal->albedo(wo).g + 0.7f, 1e-6f);
  expect_samples_follow(mask.constant(), "mask");
  expect_weights_are_right(mask.constant());
}

TEST(Mask, MayHoldATwosided) {
  AtHit mask({MaskDescription{1, {0.5f}}, TwosidedDescription{2, 3}, kRed, kMetal});
  EXPECT_GT(mask.constant().value(direction(-0.5f, 1), direction(-0.5f, 4)).f.r, 0);
  expect_samples_follow(mask.constant(), "mask of twosided");
}

TEST(MaskTwin, DensityOfTheWholeMaterialIsRejected) {
  AtHit mask({MaskDescription{1, {0.3f}}, kMetal});
  EXPECT_LT(test_sampling(mask.constant(), *make(kMetal), direction(0.6f, 0.4f)).p_value, 1e-12);
}

TEST(Mask, OpacityMayBeATexture) {
  AtHit mask({MaskDescription{1, {1, 0}}, kRed}, {quarters()});
  ASSERT_TRUE(mask.has_texture());
  const Vec3f wo = direction(0.6f, 0.4f), wi = direction(0.5f, 3.3f);
  EXPECT_FLOAT_EQ(mask.at(place(0.1f)).value(wo, wi).f.r, 0.25f * 0.8f * kInvPi);
  EXPECT_FLOAT_EQ(mask.at(place(0.9f)).value(wo, wi).f.r, 0.75f * 0.8f * kInvPi);
}

TEST(Mask, CutOffCoversAllOrNothing) {
  const Vec3f wo = direction(0.6f, 0.4f), wi = direction(0.5f, 3.3f);
  // 0.8 times a quarter is below the cut-off, times three quarters above it.
  AtHit mask({MaskDescription{1, {0.8f, 0}, 0.5f}, kRed}, {quarters()});
  EXPECT_TRUE(mask.at(place(0.1f)).value(wo, wi).f.is_black());
  EXPECT_TRUE(mask.at(place(0.1f)).sample(wo, 0, {0.2f, 0.2f})->delta);
  EXPECT_FLOAT_EQ(mask.at(place(0.9f)).value(wo, wi).f.r, 0.8f * kInvPi);
  EXPECT_FALSE(mask.at(place(0.9f)).sample(wo, 0.999f, {0.2f, 0.2f})->delta);
  expect_samples_follow(mask.at(place(0.9f)), "mask above its cut-off");
  // Without a texture; the cut-off itself is covered.
  EXPECT_FLOAT_EQ(AtHit({MaskDescription{1, {0.5f}, 0.5f}, kRed}).constant().value(wo, wi).f.r, 0.8f * kInvPi);
  EXPECT_TRUE(AtHit({MaskDescription{1, {0.49f}, 0.5f}, kRed}).constant().value(wo, wi).f.is_black());
}

TEST(Blend, MixesValuesAndDensities) {
  AtHit blend({BlendDescription{1, 2, {0.3f}}, kRed, kMetal});
  const auto red = make(kRed), metal = make(kMetal);
  const Vec3f wo = direction(0.6f, 0.4f), wi = direction(0.5f, 3.3f);
  EXPECT_FLOAT_EQ(blend.constant().value(wo, wi).f.r, 0.7f * red->value(wo, wi).f.r + 0.3f * metal->value(wo, wi).f.r);
  EXPECT_FLOAT_EQ(blend.constant().albedo(wo).r, 0.7f * red->albedo(wo).r + 0.3f * metal->albedo(wo).r);
  EXPECT_FALSE(blend.constant().transmits());
  expect_samples_follow(blend.constant(), "blend");
  expect_weights_are_right(blend.constant());
  AtHit glassy({BlendDescription{1, 2, {0.6f}}, kRed, kGround});
  EXPECT_TRUE(glassy.constant().transmits());
  expect_samples_follow(glassy.constant(), "blend with ground glass");
  expect_weights_are_right(glassy.constant());
}

// Twin: the density of the chosen half alone, which would break multiple importance sampling without a trace in single means.
TEST(BlendTwin, DensityOfOneHalfIsRejected) {
  AtHit blend({BlendDescription{1, 2, {0.3f}}, kRed, kMetal});
  EXPECT_LT(test_sampling(blend.constant(), *make(kRed), direction(0.6f, 0.4f)).p_value, 1e-12);
}

TEST(Blend, WithADeltaKeepsItsProbability) {
  AtHit blend({BlendDescription{1, 2, {0.4f}}, kRed, perfect_mirror()});
  const auto mirrored = blend.constant().sample(direction(0.6f, 0.4f), 0.39f, {0.1f, 0.2f});
  ASSERT_TRUE(mirrored && mirrored->delta);
  EXPECT_EQ(mirrored->weight, Rgb{1.0f});
  const auto scattered = blend.constant().sample(direction(0.6f, 0.4f), 0.41f, {0.1f, 0.2f});
  ASSERT_TRUE(scattered && !scattered->delta);
  EXPECT_FLOAT_EQ(scattered->pdf, 0.6f * scattered->wi.z * kInvPi);
  EXPECT_NEAR(scattered->weight.r, 0.8f, 1e-6f);
}

TEST(ThinDielectric, CountsAllReflectionsBetweenItsFaces) {
  const auto pane = make(ThinDielectricDescription{});
  for (const float z : {1.0f, 0.5f, 0.1f, -0.4f}) {
    const Vec3f wo = direction(z, 2);
    // The series R + T R T + T R^3 T + ... in double precision.
    const double r = static_cast<double>(fresnel_dielectric(std::abs(z), DielectricDescription{}.eta).reflectance), t = 1 - r;
    double series = r;
    for (double term = t * r * t; term > 1e-12; term *= r * r) series += term;
    const auto reflected = pane->sample(wo, static_cast<float>(series) * 0.999f, {});
    ASSERT_TRUE(reflected && reflected->delta);
    EXPECT_EQ(reflected->wi, reflect(wo));
    const auto passed = pane->sample(wo, static_cast<float>(series) * 1.001f, {});
    ASSERT_TRUE(passed && passed->delta);
    EXPECT_EQ(passed->wi, -wo);
    EXPECT_EQ(passed->eta, 1);
    EXPECT_EQ(passed->weight, Rgb{1.0f}) << "no scaling of radiance: the same medium on both sides";
    EXPECT_NEAR(pane->albedo(wo).g, 1, 1e-6f);
  }
}

// ---- normal and bump maps ----

Rgb encoded(Vec3f n) { return {0.5f * (n.x + 1), 0.5f * (n.y + 1), 0.5f * (n.z + 1)}; }
TextureDescription everywhere(Rgb colour) { return CheckerboardDescription{colour, colour, {}}; }

TEST(NormalMap, TiltsTheFrame) {
  const Vec3f n = direction(0.8f, 0.7f);
  AtHit map({NormalMapDescription{1, 0}, kRed}, {everywhere(encoded(n))});
  ASSERT_TRUE(map.has_texture());
  const Bsdf& bsdf = map.at(place(0.1f));
  const Vec3f wo = direction(0.9f, 2), wi = direction(0.7f, 1);
  // f cos = albedo / pi * (n . wi)
  EXPECT_NEAR(bsdf.value(wo, wi).f.r * wi.z, 0.8f * kInvPi * dot(n, wi), 1e-5f);
  EXPECT_NEAR(bsdf.value(wo, wi).pdf, kInvPi * dot(n, wi), 1e-5f);
  // Above the surface and below the tilted one.
  EXPECT_TRUE(bsdf.value(wo, direction(0.1f, 0.7f + kPi)).f.is_black());
  expect_samples_follow(bsdf, "normal map");
  expect_weights_are_right(bsdf);
}

TEST(NormalMap, OfTheSurfacesOwnNormalChangesNothing) {
  AtHit map({NormalMapDescription{1, 0}, kMetal}, {everywhere({0.5f, 0.5f, 1})});
  const auto metal = make(kMetal);
  const Vec3f wo = direction(0.6f, 2), wi = direction(0.7f, 5);
  EXPECT_NEAR(map.at(place(0)).value(wo, wi).f.r / metal->value(wo, wi).f.r, 1, 1e-6f);
}

TEST(NormalMap, ThatPointsDownLeavesNoLightOnADiffuseSurface) {
  AtHit map({NormalMapDescription{1, 0}, kRed}, {everywhere(encoded({0, 0, -1}))});
  const Bsdf& bsdf = map.at(place(0));
  EXPECT_TRUE(bsdf.value(direction(0.6f, 2), direction(0.7f, 5)).f.is_black());
  EXPECT_FALSE(bsdf.sample(direction(0.6f, 2), 0.5f, {0.5f, 0.2f}));
}

TEST(NormalMap, TurnsAnisotropyWithTheSurfacesTangent) {
  const MaterialDescription brushed = RoughConductorDescription{gold(), {MicrofacetDistribution::kGgx, 0.1f, 0.5f}};
  const Vec3f n = direction(0.9f, 0.0f);  // tilted about t
  AtHit map({NormalMapDescription{1, 0}, brushed}, {everywhere(encoded(n))});
  const auto flat = make(brushed);
  const Frame frame = tilted_frame(n);
  EXPECT_NEAR(frame.t.y, 1, 1e-6f);
  const Vec3f wo = direction(0.9f, 2), wi = direction(0.8f, 4);
  const float expected = flat->value(frame.to_local(wo), frame.to_local(wi)).f.r * dot(n, wi) / wi.z;
  EXPECT_NEAR(map.at(place(0)).value(wo, wi).f.r / expected, 1, 1e-3f);
}

TEST(NormalMap, ScaleFlattensOrTurnsTheTilt) {
  AtHit map({NormalMapDescription{1, 0, -0.5f}, kRed}, {everywhere(encoded(normalize({0.4f, 0.6f, 1})))});
  const Vec3f n = normalize({-0.2f, -0.3f, 1}), wo = direction(0.9f, 2), wi = direction(0.7f, 1);
  EXPECT_NEAR(map.at(place(0)).value(wo, wi).f.r * wi.z, 0.8f * kInvPi * dot(n, wi), 1e-5f);
  expect_samples_follow(map.at(place(0)), "scaled normal map");
}

TEST(NormalMap, YAgainstVFollowsTheTexture) {
  AtHit map({NormalMapDescription{1, 0, 1, true}, kRed}, {everywhere(encoded(normalize({0, 0.6f, 1})))});
  const Vec3f wo = direction(0.9f, 2), wi = direction(0.7f, 1);
  const auto radiance = [&](Vec3f dp_dv) {
    MaterialPoint point = place(0);
    point.dp_du = {2, 0, 0};
    point.dp_dv = dp_dv;
    return map.at(point).value(wo, wi).f.r * wi.z;
  };
  EXPECT_NEAR(radiance({0.3f, -3, 0}), 0.8f * kInvPi * dot(normalize({0, 0.6f, 1}), wi), 1e-5f);  // v runs down, y up
  EXPECT_NEAR(radiance({0.3f, 3, 0}), 0.8f * kInvPi * dot(normalize({0, -0.6f, 1}), wi), 1e-5f);
}

TEST(NormalMapTwin, DensityOfATiltOffByTwoDegreesIsRejected) {
  AtHit map({NormalMapDescription{1, 0}, kMetal}, {everywhere(encoded(direction(0.9f, 0.7f)))});
  AtHit other({NormalMapDescription{1, 0}, kMetal}, {everywhere(encoded(direction(0.882f, 0.7f)))});
  EXPECT_LT(test_sampling(map.at(place(0)), other.at(place(0)), direction(0.9f, 2)).p_value, 1e-12);
}

// A ramp: height rises by 1/2 from the centre of the left texel to that of the right one, half of the square away.
TextureDescription ramp() {
  BitmapDescription d;
  d.image = std::make_shared<const TextureImage>(2, 1, 1, std::vector<float>{0.25f, 0.75f});
  d.wrap = TextureWrap::kClamp;
  return d;
}

TEST(BumpMap, TakesItsNormalFromTheSlope) {
  // u over 2 m, v over 3 m: the height rises by scale * 1 per unit of u, so by scale / 2 per metre.
  MaterialPoint point = place(0.5f);
  point.dp_du = {2, 0, 0};
  point.dp_dv = {0, 3, 0};
  AtHit map({BumpMapDescription{1, 0, 0.8f}, kRed}, {ramp()});
  const Vec3f n = normalize({-0.4f, 0, 1});
  const Vec3f wo = direction(0.9f, 2), wi = direction(0.7f, 1);
  EXPECT_NEAR(map.at(point).value(wo, wi).f.r * wi.z, 0.8f * kInvPi * dot(n, wi), 1e-5f);
  expect_samples_follow(map.at(point), "bump map");
  // Left-handed texture coordinates: the normal stays on the geometric side.
  point.dp_dv = {0, -3, 0};
  EXPECT_NEAR(map.at(point).value(wo, wi).f.r * wi.z, 0.8f * kInvPi * dot(n, wi), 1e-5f);
}

TEST(BumpMapTwin, ASlopeTheOtherWayIsNoticed) {
  MaterialPoint point = place(0.5f);
  point.dp_du = {2, 0, 0};
  point.dp_dv = {0, 3, 0};
  AtHit map({BumpMapDescription{1, 0, -0.8f}, kRed}, {ramp()});
  const Vec3f n = normalize({-0.4f, 0, 1}), wi = direction(0.7f, 1);
  EXPECT_GT(std::abs(map.at(point).value(direction(0.9f, 2), wi).f.r * wi.z - 0.8f * kInvPi * dot(n, wi)), 0.05f);
}

// ---- nesting ----

TEST(NestedMaterials, TexturesAreFoundAtAnyDepth) {
  const TextureDescription colours = CheckerboardDescription{{0.8f, 0.3f, 0.1f}, {0.2f, 0.6f, 0.9f}, Transform::scale(1, 0, 1)};
  const std::vector<MaterialDescription> materials{MaskDescription{1, {0.5f}}, BlendDescription{2, 4, {1, 1}},
                                                   TwosidedDescription{3, 4}, DiffuseDescription{Rgb{1}, 0}, kMetal};
  AtHit nested(materials, {colours, quarters()});
  const auto metal = make(kMetal);
  const Vec3f wo = direction(0.6f, 0.4f), wi = direction(0.5f, 3.3f);
  const float expected = 0.5f * (0.75f * 0.3f * kInvPi + 0.25f * metal->value(wo, wi).f.g);
  EXPECT_NEAR(nested.at(place(0.1f)).value(wo, wi).f.g, expected, 1e-6f);
  // From behind the twosided shows metal, the one-sided metal nothing.
  const Vec3f behind_o{wo.x, wo.y, -wo.z}, behind_i{wi.x, wi.y, -wi.z};
  EXPECT_NEAR(nested.at(place(0.9f)).value(behind_o, behind_i).f.g, 0.5f * 0.25f * metal->value(wo, wi).f.g, 1e-6f);
}

TEST(NestedMaterials, ThatHoldThemselvesAreRefused) {
  EXPECT_THROW(make_bsdfs({MaskDescription{0, {0.5f}}}), SceneError);
  EXPECT_THROW(make_bsdfs({MaskDescription{1, {0.5f}}, BlendDescription{2, 0, {0.5f}}, kRed}), SceneError);
  EXPECT_THROW(make_bsdfs({BlendDescription{1, 2, {0.5f}}, kRed}), SceneError);
  EXPECT_THROW(make_bsdfs({TwosidedDescription{1, 1}, MaskDescription{2, {0.5f}}, kRed}), SceneError);
}

TEST(NestedMaterials, TooManyForTheRoomAtAHitAreRefused) {
  std::vector<MaterialDescription> materials;
  for (int i = 0; i < 60; ++i) materials.push_back(MaskDescription{i + 1, {1, 0}});
  materials.push_back(kRed);
  EXPECT_THROW(AtHit(materials, {quarters()}), SceneError);
}

}  // namespace
}  // namespace fluxfarm::testing
