// A textured material at a hit is the constant material of the colour that the texture has there.
#include <gtest/gtest.h>

#include "cases.h"
#include "materials/make_textured.h"
#include "support/chi_square.h"

namespace fluxfarm::testing {
namespace {

const Rgb kLeft{0.8f, 0.3f, 0.1f}, kRight{0.2f, 0.6f, 0.9f};
constexpr Vec2f kOnLeft{0.1f, 0.1f}, kOnRight{0.9f, 0.1f};

// kLeft where u is below a half, kRight above it.
TextureDescription halves() { return CheckerboardDescription{kLeft, kRight, Transform::scale(1, 0, 1)}; }

struct TexturedCase {
  std::string name;
  MaterialDescription textured;
  MaterialDescription (*constant)(Rgb colour);  // the same with that colour instead of the texture
};

MaterialDescription plastic(Rgb diffuse, Rgb specular, int diffuse_texture, int specular_texture) {
  PlasticDescription d = painted_plastic(true);
  d.diffuse_reflectance = diffuse;
  d.specular_reflectance = specular;
  d.diffuse_reflectance_texture = diffuse_texture;
  d.specular_reflectance_texture = specular_texture;
  return d;
}
MaterialDescription rough(const MaterialDescription& plastic) {
  return RoughPlasticDescription{std::get<PlasticDescription>(plastic), ggx(0.3f)};
}
MaterialDescription metal(Rgb colour, int texture) {
  ConductorDescription d = gold();
  d.specular_reflectance = colour;
  d.specular_reflectance_texture = texture;
  return d;
}
MaterialDescription rough_metal(Rgb colour, int texture) {
  return RoughConductorDescription{std::get<ConductorDescription>(metal(colour, texture)), beckmann(0.3f)};
}
DielectricDescription glass(Rgb colour, int texture) {
  DielectricDescription d;
  d.specular_reflectance = {0.9f, 0.8f, 0.7f};
  d.specular_transmittance = colour;
  d.specular_transmittance_texture = texture;
  return d;
}

// Shiny and fuzzy: the factors of its reflectance and of the roughness of its sheen show.
MaterialDescription gltf(float specular, float sheen_roughness, int specular_texture, int sheen_roughness_texture) {
  GltfDescription d;
  d.metallic = 0;
  d.roughness = 0.4f;
  d.base_color = {0.2f, 0.1f, 0.3f};
  d.sheen_color = Rgb{0.8f};
  d.specular = specular;
  d.sheen_roughness = sheen_roughness;
  d.specular_texture = specular_texture;
  d.sheen_roughness_texture = sheen_roughness_texture;
  return d;
}

std::vector<TexturedCase> cases() {
  const Rgb one{1.0f}, half{0.5f};
  return {
      {"diffuse", DiffuseDescription{one, 0}, [](Rgb c) -> MaterialDescription { return DiffuseDescription{c}; }},
      {"conductor", metal(one, 0), [](Rgb c) { return metal(c, kNoTexture); }},
      {"roughconductor", rough_metal(one, 0), [](Rgb c) { return rough_metal(c, kNoTexture); }},
      {"dielectric", glass(one, 0), [](Rgb c) -> MaterialDescription { return glass(c, kNoTexture); }},
      {"roughdielectric", RoughDielectricDescription{glass(one, 0), ggx(0.3f)},
       [](Rgb c) -> MaterialDescription {
         return RoughDielectricDescription{glass(c, kNoTexture), ggx(0.3f)};
       }},
      {"plastic diffuse", plastic(one, half, 0, kNoTexture), [](Rgb c) { return plastic(c, Rgb{0.5f}, kNoTexture, kNoTexture); }},
      {"plastic specular", plastic(half, one, kNoTexture, 0), [](Rgb c) { return plastic(Rgb{0.5f}, c, kNoTexture, kNoTexture); }},
      {"gltf specular", gltf(1, 0.5f, 0, kNoTexture), [](Rgb c) { return gltf(c.r, 0.5f, kNoTexture, kNoTexture); }},
      {"gltf sheen", gltf(1, 1, kNoTexture, 0), [](Rgb c) { return gltf(1, c.r, kNoTexture, kNoTexture); }},
      {"roughplastic", rough(plastic(one, one, 0, 0)), [](Rgb c) { return rough(plastic(c, c, kNoTexture, kNoTexture)); }}};
}

// A textured material with all that it borrows.
class Textured {
 public:
  explicit Textured(const MaterialDescription& d, const TextureDescription& texture = halves())
      : textures_(make_textures({texture})), bsdfs_(make_bsdfs({d})), materials_(make_textured_materials({d}, bsdfs_, textures_)) {}

  const Bsdf& at(Vec2f uv) { return materials_[0]->at({.texture = {.uv = uv}}, space_); }
  bool has_texture() const { return materials_[0] != nullptr; }

 private:
  Textures textures_;
  std::vector<std::unique_ptr<Bsdf>> bsdfs_;
  std::vector<std::unique_ptr<TexturedMaterial>> materials_;
  BsdfSpace space_;
};

void expect_near(Rgb a, Rgb b, float tolerance) {
  for (const auto& [x, y] : {std::pair{a.r, b.r}, {a.g, b.g}, {a.b, b.b}})
    EXPECT_NEAR(x, y, tolerance * std::max(1.0f, std::fabs(y)));
}

// Largest difference between what the two scatter over some directions, relative to one.
float difference(const Bsdf& a, const Bsdf& b) {
  float worst = 0;
  const auto compare = [&](Rgb x, Rgb y) {
    worst = std::max(worst, std::max({std::fabs(x.r - y.r), std::fabs(x.g - y.g), std::fabs(x.b - y.b)}));
  };
  for (const float z : {0.9f, 0.4f, -0.6f}) {
    const Vec3f wo = direction(z, 0.3f);
    for (int i = 0; i < 64; ++i) {
      const Vec2f u{(static_cast<float>(i % 8) + 0.5f) / 8, (static_cast<float>(i / 8) + 0.5f) / 8};
      const auto s = a.sample(wo, 0.77f * u.x, u), t = b.sample(wo, 0.77f * u.x, u);
      if (s.has_value() != t.has_value()) return 1;
      if (!s) continue;
      compare(s->weight, t->weight);
      worst = std::max(worst, length(s->wi - t->wi));
      compare(a.value(wo, s->wi).f, b.value(wo, s->wi).f);
      worst = std::max(worst, std::fabs(a.pdf(wo, s->wi) - b.pdf(wo, s->wi)));
    }
  }
  return worst;
}

TEST(TexturedMaterial, ScattersAsTheConstantOneOfThatColour) {
  for (const TexturedCase& c : cases()) {
    SCOPED_TRACE(c.name);
    Textured textured(c.textured);
    EXPECT_LT(difference(textured.at(kOnLeft), *make(c.constant(kLeft))), 1e-5f);
    EXPECT_LT(difference(textured.at(kOnRight), *make(c.constant(kRight))), 1e-5f);
    // Twin: the colour of the other half is noticed.
    EXPECT_GT(difference(textured.at(kOnRight), *make(c.constant(kLeft))), 1e-2f);
  }
}

TEST(TexturedMaterial, HasTheAlbedoOfTheConstantOne) {
  for (const TexturedCase& c : cases()) {
    SCOPED_TRACE(c.name);
    Textured textured(c.textured);
    const auto constant = make(c.constant(kRight));
    // roughplastic joins a table and a product: 0.02 is what the tables promise.
    for (const float z : {1.0f, 0.5f, -0.5f}) {
      expect_near(textured.at(kOnRight).albedo(direction(z, 1)), constant->albedo(direction(z, 1)),
                  c.name == "roughplastic" ? 0.02f : 1e-4f);
    }
  }
}

TEST(TexturedMaterial, AnswersAsTheConstantOneAboutItsLobes) {
  for (const TexturedCase& c : cases()) {
    SCOPED_TRACE(c.name);
    Textured textured(c.textured);
    const auto constant = make(c.constant(kLeft));
    EXPECT_EQ(textured.at(kOnLeft).has_continuous_lobe(), constant->has_continuous_lobe());
    EXPECT_EQ(textured.at(kOnLeft).chooses_lobe(), constant->chooses_lobe());
    EXPECT_EQ(textured.at(kOnLeft).transmits(), constant->transmits());
  }
}

TEST(TexturedMaterial, GltfMultipliesItsBaseColourByThatOfTheVertices) {
  GltfDescription d;
  d.base_color = {0.9f, 0.6f, 0.3f};
  d.roughness = 0.5f;
  d.vertex_colors = true;
  const auto bsdfs = make_bsdfs({d});
  const auto materials = make_textured_materials({d}, bsdfs, {});
  BsdfSpace space;
  const Bsdf& at = materials[0]->at({.texture = {.uv = {}, .vertex_color = kLeft}}, space);
  GltfDescription constant = d;
  constant.vertex_colors = false;
  EXPECT_GT(difference(at, *make(constant)), 1e-2f);
  constant.base_color = d.base_color * kLeft;
  EXPECT_LT(difference(at, *make(constant)), 1e-5f);
}

TEST(TexturedMaterial, IsOnlyMadeWhereAParameterHasATexture) {
  EXPECT_FALSE(Textured(DiffuseDescription{}).has_texture());
  EXPECT_FALSE(Textured(rough(plastic(Rgb{1.0f}, Rgb{1.0f}, kNoTexture, kNoTexture))).has_texture());
  EXPECT_FALSE(Textured(RoughDielectricDescription{}).has_texture());
}

TEST(TexturedMaterial, RoughnessIsTheLuminanceOfItsTexture) {
  RoughConductorDescription d{gold(), ggx(1)};
  d.roughness.alpha_texture = 0;
  Textured textured(d, CheckerboardDescription{Rgb{0.2f}, Rgb{0.6f}, Transform::scale(1, 0, 1)});
  EXPECT_LT(difference(textured.at(kOnLeft), *make(RoughConductorDescription{gold(), ggx(0.2f)})), 1e-5f);
  EXPECT_LT(difference(textured.at(kOnRight), *make(RoughConductorDescription{gold(), ggx(0.6f)})), 1e-5f);
  EXPECT_GT(difference(textured.at(kOnRight), *make(RoughConductorDescription{gold(), ggx(0.2f)})), 1e-2f);
  expect_near(textured.at(kOnLeft).albedo(direction(0.5f, 0)),
              make(RoughConductorDescription{gold(), ggx(0.4f)})->albedo(direction(0.5f, 0)), 1e-4f);
}

// p-value of the samples at `sampled` against the density at `stated`.
double sampling_p_value(Textured& material, Textured& other, Vec2f sampled, Vec2f stated) {
  const Bsdf& samples = material.at(sampled);
  const Bsdf& states = other.at(stated);
  const Vec3f wo = direction(0.6f, 0.4f);
  const auto sample = [&](float u_lobe, Vec2f u) -> std::optional<Vec3f> {
    const auto s = samples.sample(wo, u_lobe, u);
    if (!s || s->delta) return std::nullopt;
    return s->wi;
  };
  return chi_square({}, sample, [&](Vec3f wi) { return static_cast<double>(states.pdf(wo, wi)); }).p_value;
}

// The choice between coat and base follows the colours of the place.
TEST(TexturedMaterial, PlasticsSampleByTheDensityOfThePlace) {
  const MaterialDescription coats[] = {plastic(Rgb{1.0f}, Rgb{0.5f}, 0, kNoTexture),
                                       rough(plastic(Rgb{1.0f}, Rgb{0.5f}, 0, kNoTexture))};
  const TextureDescription dark_and_light = CheckerboardDescription{Rgb{0.02f}, Rgb{0.9f}, Transform::scale(1, 0, 1)};
  const double level = sidak_level(0.01, 4);  // 1 % over all cases
  for (const MaterialDescription& coat : coats) {
    Textured a(coat, dark_and_light), b(coat, dark_and_light);
    for (const Vec2f place : {kOnLeft, kOnRight}) EXPECT_GT(sampling_p_value(a, b, place, place), level);
    // Twin: the density of another place is rejected.
    EXPECT_LT(sampling_p_value(a, b, kOnLeft, kOnRight), 1e-12);
  }
}

}  // namespace
}  // namespace fluxfarm::testing
