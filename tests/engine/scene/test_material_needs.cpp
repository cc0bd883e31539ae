// What a scene computes at a hit follows from its materials: no more than they need.
#include <gtest/gtest.h>

#include "materials/cases.h"
#include "scene/material_needs.h"

namespace fluxfarm {
namespace {

MaterialNeeds needs(const std::vector<MaterialDescription>& materials) {
  SceneDescription scene;
  scene.materials = materials;
  scene.textures = {CheckerboardDescription{}, MeshAttributeDescription{}};
  return material_needs(scene, 0);
}

TEST(MaterialNeeds, AreNothingForConstantMaterials) {
  const MaterialNeeds n = needs({TwosidedDescription{1, 2}, DiffuseDescription{}, PrincipledDescription{}});
  EXPECT_FALSE(n.anisotropic || n.normal_maps || n.tangents || n.uvs || n.uv_derivatives || n.vertex_colors || n.masks);
}

TEST(MaterialNeeds, AreThoseOfAllThatIsHeld) {
  DiffuseDescription painted;
  painted.reflectance_texture = 1;
  const MaterialNeeds n = needs({MaskDescription{1, {0.5f}}, BlendDescription{2, 3, {1, 0}}, painted, DiffuseDescription{}});
  EXPECT_TRUE(n.masks && n.uvs && n.vertex_colors);
  EXPECT_FALSE(n.tangents || n.uv_derivatives);
}

TEST(MaterialNeeds, OfNormalMapsAreTangentsAndOfBumpMapsDerivativesToo) {
  const MaterialNeeds normals = needs({NormalMapDescription{1, 0}, DiffuseDescription{}});
  EXPECT_TRUE(normals.normal_maps && normals.tangents && normals.uvs);
  EXPECT_FALSE(normals.uv_derivatives || normals.anisotropic);
  EXPECT_TRUE(needs({NormalMapDescription{1, 0, 1, true}, DiffuseDescription{}}).uv_derivatives);
  EXPECT_TRUE(needs({BumpMapDescription{1, 0, 1}, DiffuseDescription{}}).uv_derivatives);
}

// All materials that hold no others.
std::vector<testing::MaterialCase> all_cases() {
  std::vector<testing::MaterialCase> cases = testing::continuous_cases();
  cases.push_back({"principled", PrincipledDescription{}});
  cases.push_back({"gltf", GltfDescription{}});
  cases.push_back({"dielectric", DielectricDescription{}});
  cases.push_back({"thindielectric", ThinDielectricDescription{}});
  cases.push_back({"conductor", testing::gold()});
  cases.push_back({"null", NullDescription{}});
  return cases;
}

// Who scatters into single directions has said so; and who has said so does it.
TEST(MaterialNeeds, OfDeltaLobesAreThoseThatSamplingShows) {
  for (const testing::MaterialCase& c : all_cases()) {
    const std::unique_ptr<Bsdf> bsdf = testing::make(c.description);
    bool delta = false;
    for (int i = 0; i < 64; ++i) {
      const float u = (static_cast<float>(i) + 0.5f) / 64;
      const std::optional<BsdfSample> s = bsdf->sample(testing::direction(0.4f, 1), u, {u, 1 - u});
      delta |= s && s->delta && !s->passes;
    }
    EXPECT_EQ(needs({c.description}).delta_lobes, delta) << c.name;
  }
  EXPECT_TRUE(needs({MaskDescription{1, {0.5f}}, PlasticDescription{}}).delta_lobes);
}

// Photons of caustics are shot at glossy surfaces alone: what is not glossy may scatter nothing sharply.
TEST(MaterialNeeds, OfGlossAreThoseThatScatterMoreNarrowlyThanADiffuseSurface) {
  int dull = 0;
  for (const testing::MaterialCase& c : all_cases()) {
    if (needs({c.description}).glossy) continue;
    ++dull;
    const std::unique_ptr<Bsdf> bsdf = testing::make(c.description);
    for (int i = 0; i < 1024; ++i) {
      const float u = (static_cast<float>(i) + 0.5f) / 1024;
      const std::optional<BsdfSample> s = bsdf->sample(testing::direction(u, 1), u, {u, 32 * u - std::floor(32 * u)});
      if (!s || s->passes) continue;
      EXPECT_FALSE(s->delta) << c.name;
      EXPECT_LE(max_component(s->weight) * s->pdf / std::fabs(s->wi.z), 0.3184f) << c.name;  // 1 / pi
    }
  }
  EXPECT_EQ(dull, 2);  // diffuse and null
  EXPECT_TRUE(needs({TwosidedDescription{1, 2}, DiffuseDescription{}, PlasticDescription{}}).glossy);
  EXPECT_TRUE(needs({BlendDescription{1, 2, {0.5f}}, DiffuseDescription{}, RoughConductorDescription{}}).glossy);
  EXPECT_TRUE(needs({NormalMapDescription{1, 0}, DiffuseDescription{}}).glossy);
  EXPECT_TRUE(needs({BumpMapDescription{1, 0, 1}, DiffuseDescription{}}).glossy);
}

TEST(MaterialNeeds, OfGltfAreVertexColorsWhereItShowsThem) {
  GltfDescription d;
  EXPECT_FALSE(needs({d}).vertex_colors || needs({d}).uvs);
  d.vertex_colors = true;
  EXPECT_TRUE(needs({d}).vertex_colors);
  EXPECT_FALSE(needs({d}).uvs);
  d.sheen_roughness_texture = 0;
  EXPECT_TRUE(needs({d}).uvs);
}

TEST(MaterialNeeds, OfTwoRoughnessesAreTangents) {
  RoughConductorDescription brushed;
  brushed.roughness.alpha_u = 0.3f;
  EXPECT_TRUE(needs({brushed}).anisotropic);
  PrincipledDescription principled;
  principled.anisotropic = {0.2f};
  EXPECT_TRUE(needs({principled}).tangents);
}

}  // namespace
}  // namespace fluxfarm
