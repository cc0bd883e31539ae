// glTF surfaces beyond factors and colours: volumes that absorb, alpha, normal maps, colours of vertices. Descriptions, and
// radiance that is known in closed form, with must-fail twins: M1 of the accuracy catalogue for the volume.
#include <algorithm>
#include <cmath>
#include <limits>

#include "io/data_uri.h"
#include "io/gltf_builder.h"
#include "support/scene_builder.h"

namespace fluxfarm {
namespace {

using testing::measure;
using testing::Measurement;

// Two texels: red with alpha 51, blue with alpha 255.
constexpr const char* kAlphaPng =
    "data:image/png;base64,"
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAYAAAD0In+KAAAAEUlEQVR42mP4z8BgzMDw/z8AC/0DMfI9sDYAAAAASUVORK5CYII=";
// Two texels, red and blue, without alpha.
constexpr const char* kOpaquePng =
    "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAADUlEQVR4nGP4zwAE/wEHAAH/4iOeWQAAAABJRU5ErkJggg==";
// One texel, (128, 218, 218): half way between +y and +z.
constexpr const char* kUpPng =
    "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR42mNouHULAAQSAjV9oLlAAAAAAElFTkSuQmCC";
// A surface that reflects base / pi and nothing else.
constexpr const char* kLambert =
    R"("extensions": {"KHR_materials_specular": {"specularFactor": 0}}, "pbrMetallicRoughness": {"metallicFactor": 0)";

GltfBuilder& with_image(GltfBuilder& gltf, const std::string& uri) {
  gltf.add("images", "{\"uri\": \"" + uri + "\"}").add("samplers", R"({"magFilter": 9728, "wrapS": 33071, "wrapT": 33071})");
  return gltf.add("textures", R"({"source": 0, "sampler": 0})");
}

// Radiance at one point, seen from another.
Measurement seen(SceneDescription scene, const std::array<double, 3>& from, const std::array<double, 3>& at,
                 std::uint32_t spp = 64) {
  const SceneDescription look = testing::SceneBuilder().look(from, at).description();
  scene.camera = look.camera;
  scene.film = look.film;
  return measure(scene, spp);
}

// Unit square in z = 0 that faces +z, with those texture coordinates, under a point light 3 m above and 4 m before its centre.
SceneDescription lit_square(const std::vector<float>& uvs, const std::string& material, const std::string& nodes = R"({"mesh": 0})",
                            const std::vector<float>& colors = {}) {
  const SceneFolder folder;
  GltfBuilder gltf;
  gltf.accessor<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3);
  gltf.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
  gltf.accessor(uvs, 2);
  gltf.accessor<std::uint16_t>({0, 1, 2, 0, 2, 3}, 1);
  if (!colors.empty()) gltf.accessor(colors, 3);
  gltf.add("meshes", std::string(R"({"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2)") +
                         (colors.empty() ? "" : ", \"COLOR_0\": 4") + R"(}, "indices": 3, "material": 0}]})");
  gltf.add("nodes", nodes);
  gltf.add("nodes", R"({"translation": [0.5, 3.5, 4], "extensions": {"KHR_lights_punctual": {"light": 0}}})");
  gltf.more(R"(, "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 100}]}})");
  with_image(gltf, kUpPng).add("materials", std::string("{") + kLambert + "}" + material + "}");
  return gltf.read(folder);
}

// The innermost material of a shape, and those around it.
template <typename Description>
const Description* held(const SceneDescription& scene, std::size_t shape = 0) {
  std::size_t material = static_cast<std::size_t>(scene.shapes.at(shape).material);
  for (;;) {
    const MaterialDescription& d = scene.materials.at(material);
    if (const auto* wanted = std::get_if<Description>(&d)) return wanted;
    if (const auto* mask = std::get_if<MaskDescription>(&d)) {
      material = static_cast<std::size_t>(mask->material);
    } else if (const auto* map = std::get_if<NormalMapDescription>(&d)) {
      material = static_cast<std::size_t>(map->material);
    } else {
      return nullptr;
    }
  }
}

// ---------------------------------------------------------------- volumes

// A cube of 6 x 6 x 1 m at the origin and another one aside.
SceneDescription glass_block(const std::string& volume) {
  const SceneFolder folder;
  GltfBuilder gltf;
  const MeshDescription cube = testing::cube(Transform());
  std::vector<float> positions;
  for (const Vec3f& p : cube.positions) positions.insert(positions.end(), {p.x, p.y, p.z});
  gltf.accessor(positions, 3);
  gltf.accessor(cube.indices, 1);
  gltf.add("meshes", R"({"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]})");
  gltf.add("nodes", R"({"mesh": 0, "scale": [3, 3, 0.5]}, {"mesh": 0, "translation": [20, 0, 0]})");
  gltf.add("materials", R"({"pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0}, "extensions":
    {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_volume": {)" +
                            volume + "}}}");
  return gltf.read(folder);
}

TEST(GltfVolume, AbsorbsItsColourOverItsDistance) {
  const SceneDescription scene =
      glass_block(R"("thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [0.9, 0.25, 0])");
  ASSERT_EQ(scene.media.size(), 1u) << "one for both shapes of the material";
  EXPECT_EQ(scene.shapes[0].interior_medium, 0);
  EXPECT_EQ(scene.shapes[1].interior_medium, 0);
  EXPECT_EQ(scene.shapes[0].exterior_medium, kNoMedium);
  EXPECT_EQ(scene.media[0].albedo, Rgb{0});
  EXPECT_FLOAT_EQ(scene.media[0].sigma_t.r, 0.052680258f);  // -ln 0.9 / 2 m
  EXPECT_FLOAT_EQ(scene.media[0].sigma_t.g, 0.693147181f);  // -ln 0.25 / 2 m
  EXPECT_FLOAT_EQ(scene.media[0].sigma_t.b, 6.907755279f);  // black: -ln 1e-6 / 2 m
  EXPECT_FALSE(warns(scene, "attenuation"));
  // 1 m leaves a = 1/2. Straight on, before an even sky and with all reflections between the faces: R + (1 - R)^2 a / (1 - R a).
  const Measurement m = seen(scene, {0, 0, 5}, {0, 0, 0}, 16384);
  EXPECT_LE(m.z(0.04 + 0.9216 * 0.5 / (1 - 0.04 * 0.5)), 3.3) << m.mean << " +- " << m.standard_error;
  EXPECT_GT(m.z(0.04 + 0.9216 * 0.5), 3.3) << "reflections within are left out";
  EXPECT_GT(m.z(1), 3.3) << "clear";
}

TEST(GltfVolume, WithoutAttenuationHasNoMedium) {
  for (const char* volume :
       {R"("attenuationDistance": 2, "attenuationColor": [0.9, 0.25, 0])",                      // no thickness: a pane
        R"("thicknessFactor": 1, "attenuationColor": [0.9, 0.25, 0])",                          // infinitely far
        R"("thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [1, 1, 1])"}) {  // leaves everything
    const SceneDescription scene = glass_block(volume);
    EXPECT_TRUE(scene.media.empty()) << volume;
    EXPECT_EQ(scene.shapes[0].interior_medium, kNoMedium) << volume;
  }
}

// ---------------------------------------------------------------- alpha

SceneDescription black_with_alpha(const std::string& members, const std::string& factor, const char* image) {
  const SceneFolder folder;
  GltfBuilder gltf;
  with_image(gltf.square(", \"material\": 0"), image);
  gltf.add("materials", std::string("{") + kLambert + R"(, "baseColorFactor": [0, 0, 0, )" + factor +
                            R"(], "baseColorTexture": {"index": 0}})" + members + "}");
  return gltf.read(folder);
}

TEST(GltfAlpha, BlendTakesFactorAndTexture) {
  const SceneDescription scene = black_with_alpha(R"(, "alphaMode": "BLEND")", "0.5", kAlphaPng);
  const auto* mask = held<MaskDescription>(scene);
  ASSERT_NE(mask, nullptr);
  EXPECT_FLOAT_EQ(mask->opacity.factor, 0.5f);
  EXPECT_FALSE(mask->cutoff);
  const auto& alpha = std::get<BitmapDescription>(scene.textures.at(static_cast<std::size_t>(mask->opacity.texture)));
  EXPECT_FLOAT_EQ(alpha.image->texel(0, 0).g, 0.2f);  // as stored, no sRGB
  EXPECT_FLOAT_EQ(alpha.image->texel(1, 0).g, 1);
  const auto& color =
      std::get<BitmapDescription>(scene.textures.at(static_cast<std::size_t>(held<GltfDescription>(scene)->base_color_texture)));
  EXPECT_EQ(color.image->texel(0, 0), (Rgb{1, 0, 0}));
  EXPECT_TRUE(scene.warnings.size() == 2) << "camera and light";
  // A black surface before a sky of radiance 1.
  const Measurement left = seen(scene, {0.25, 0.5, 3}, {0.25, 0.5, 0}, 4096),
                    right = seen(scene, {0.75, 0.5, 3}, {0.75, 0.5, 0}, 4096);
  EXPECT_LE(left.z(0.9), 3.3) << left.mean << " +- " << left.standard_error;
  EXPECT_LE(right.z(0.5), 3.3) << right.mean << " +- " << right.standard_error;
  EXPECT_GT(left.z(1 - 0.5 * std::pow((0.2 + 0.055) / 1.055, 2.4)), 3.3) << "alpha decoded as a colour";
}

TEST(GltfAlpha, MaskShowsAllOrNothing) {
  const auto radiance = [](const std::string& members, const std::string& factor, double x) {
    return seen(black_with_alpha(members, factor, kAlphaPng), {x, 0.5, 3}, {x, 0.5, 0}).mean;
  };
  const std::string by_default = R"(, "alphaMode": "MASK")", at_texel = R"(, "alphaMode": "MASK", "alphaCutoff": 0.2)";
  EXPECT_FLOAT_EQ(static_cast<float>(radiance(by_default, "1", 0.25)), 1);
  EXPECT_NEAR(radiance(by_default, "1", 0.75), 0, 1e-6);
  EXPECT_NEAR(radiance(by_default, "0.51", 0.75), 0, 1e-6);
  EXPECT_FLOAT_EQ(static_cast<float>(radiance(by_default, "0.49", 0.75)), 1);  // the factor counts
  EXPECT_NEAR(radiance(at_texel, "1", 0.25), 0, 1e-6);                         // exactly the cut-off is opaque
  EXPECT_NEAR(radiance(R"(, "alphaMode": "OPAQUE")", "0", 0.25), 0, 1e-6);
  EXPECT_FLOAT_EQ(static_cast<float>(radiance(R"(, "alphaMode": "MASK", "alphaCutoff": 2)", "1", 0.75)), 1);
}

TEST(GltfAlpha, ImageWithoutAlphaLeavesTheFactor) {
  const SceneDescription half = black_with_alpha(R"(, "alphaMode": "BLEND")", "0.5", kOpaquePng);
  ASSERT_NE(held<MaskDescription>(half), nullptr);
  EXPECT_EQ(held<MaskDescription>(half)->opacity.texture, kNoTexture);
  EXPECT_EQ(half.textures.size(), 1u);
  for (const char* mode : {"BLEND", "MASK"}) {
    const SceneDescription whole = black_with_alpha(std::string(", \"alphaMode\": \"") + mode + "\"", "1", kOpaquePng);
    EXPECT_EQ(held<MaskDescription>(whole), nullptr) << mode << ": an opaque surface pays for no mask";
  }
  EXPECT_NE(held<MaskDescription>(black_with_alpha(R"(, "alphaMode": "MASK")", "0.4", kOpaquePng)), nullptr);
}

TEST(GltfAlpha, LightThatIsTransparentSaysSo) {
  EXPECT_TRUE(warns(black_with_alpha(R"(, "alphaMode": "BLEND", "emissiveFactor": [1, 1, 1])", "0.5", kAlphaPng),
                    "the light shines in full"));
}

// Shadow rays take a mask as opaque, and no path meets a light that is a point.
TEST(GltfAlpha, PunctualLightsThatItStopsAreAWarning) {
  const auto warns_of_shadows = [](const SceneDescription& description) {
    const Scene scene(description, 1);
    return std::ranges::any_of(scene.warnings(), [](const std::string& w) { return w.find("whole shadows") != std::string::npos; });
  };
  EXPECT_TRUE(warns_of_shadows(lit_square({0, 1, 1, 1, 1, 0, 0, 0}, R"(, "alphaMode": "MASK", "alphaCutoff": 2)")));
  EXPECT_FALSE(warns_of_shadows(lit_square({0, 1, 1, 1, 1, 0, 0, 0}, "")));
  EXPECT_FALSE(warns_of_shadows(black_with_alpha(R"(, "alphaMode": "BLEND")", "0.5", kAlphaPng)));
}

TEST(GltfAlpha, SpecularAndSheenRoughnessAreAlphaChannels) {
  const SceneFolder folder;
  GltfBuilder gltf;
  with_image(gltf.square(", \"material\": 0"), kAlphaPng);
  gltf.add("materials", R"({"extensions": {"KHR_materials_specular": {"specularTexture": {"index": 0}},
    "KHR_materials_sheen": {"sheenColorFactor": [1, 1, 1], "sheenRoughnessFactor": 1, "sheenRoughnessTexture": {"index": 0}}}})");
  const SceneDescription scene = gltf.read(folder);
  const auto* d = held<GltfDescription>(scene);
  for (const int texture : {d->specular_texture, d->sheen_roughness_texture}) {
    ASSERT_NE(texture, kNoTexture);
    const auto& bitmap = std::get<BitmapDescription>(scene.textures.at(static_cast<std::size_t>(texture)));
    EXPECT_EQ(bitmap.image->texel(0, 0), Rgb{bitmap.image->texel(0, 0).r});
    EXPECT_FLOAT_EQ(bitmap.image->texel(0, 0).r, 0.2f);
  }
}

// ---------------------------------------------------------------- normal maps

const std::vector<float> kUpright{0, 1, 1, 1, 1, 0, 0, 0}, kMirrored{1, 1, 0, 1, 0, 0, 1, 0}, kUpsideDown{0, 0, 1, 0, 1, 1, 0, 1};
constexpr double kPerCosine = 100 / 25.0 / 3.14159265358979;  // radiance of a white surface, over the cosine at the light
const double kTowards = (0.6 + 0.8) / std::sqrt(2.0), kAway = (0.8 - 0.6) / std::sqrt(2.0);  // cosines, normals at 45 degrees

double radiance_of(const SceneDescription& scene) { return seen(scene, {0.5, 0.5, 3}, {0.5, 0.5, 0}).mean / kPerCosine; }

TEST(GltfNormalMap, GreenPointsUpInTheImageHoweverItLies) {
  const std::string map = R"(, "normalTexture": {"index": 0})";
  EXPECT_NEAR(radiance_of(lit_square(kUpright, "")), 0.8, 1e-3);  // flat
  EXPECT_NEAR(radiance_of(lit_square(kUpright, map)), kTowards, 2e-3);
  EXPECT_NEAR(radiance_of(lit_square(kMirrored, map)), kTowards, 2e-3);
  EXPECT_NEAR(radiance_of(lit_square(kUpsideDown, map)), kAway, 2e-3);
  // A node that mirrors the mesh, alone and as an instance.
  const std::string mirror = R"({"mesh": 0, "scale": [-1, 1, 1], "translation": [1, 0, 0]})";
  EXPECT_NEAR(radiance_of(lit_square(kUpright, map, mirror)), kTowards, 2e-3);
  EXPECT_NEAR(radiance_of(lit_square(kUpright, map, mirror + R"(, {"mesh": 0, "translation": [9, 0, 0]})")), kTowards, 2e-3);
}

// Twin: Mitsuba's frame, in which y lies across x and the normal, would turn mirrored parts of a model inside out.
TEST(GltfNormalMapTwin, FrameThatIgnoresVIsNoticed) {
  SceneDescription scene = lit_square(kMirrored, R"(, "normalTexture": {"index": 0})");
  for (MaterialDescription& material : scene.materials)
    if (auto* map = std::get_if<NormalMapDescription>(&material)) map->y_against_v = false;
  EXPECT_NEAR(radiance_of(scene), kAway, 2e-3);
}

TEST(GltfNormalMap, ScaleActsOnXAndY) {
  const double h = 1 / std::sqrt(1.25);  // (0, 1/2, 1), normalised
  EXPECT_NEAR(radiance_of(lit_square(kUpright, R"(, "normalTexture": {"index": 0, "scale": 0.5})")), h * (0.5 * 0.6 + 0.8), 2e-3);
  EXPECT_NEAR(radiance_of(lit_square(kUpright, R"(, "normalTexture": {"index": 0, "scale": 0})")), 0.8, 2e-3);
  EXPECT_NEAR(radiance_of(lit_square(kUpright, R"(, "normalTexture": {"index": 0, "scale": -1})")), kAway, 2e-3);
}

// ---------------------------------------------------------------- colours of vertices

TEST(GltfVertexColors, MultiplyTheBaseColour) {
  // 0.2 at x = 0, 0.8 at x = 1; values beyond [0, 1] are clamped.
  const SceneDescription scene = lit_square(kUpright, "", R"({"mesh": 0})", {-3, 0.2f, 0, 7, 0.8f, 0, 7, 0.8f, 0, -3, 0.2f, 0});
  EXPECT_TRUE(held<GltfDescription>(scene)->vertex_colors);
  const auto& mesh = std::get<MeshDescription>(scene.shapes.at(0).geometry);
  ASSERT_EQ(mesh.colors.size(), 4u);
  EXPECT_EQ(mesh.colors[0], (Rgb{0, 0.2f, 0}));
  EXPECT_EQ(mesh.colors[1], (Rgb{1, 0.8f, 0}));
  EXPECT_NEAR(radiance_of(scene), 0.8 * 0.5, 1e-3);
  EXPECT_GT(std::abs(radiance_of(lit_square(kUpright, "")) - 0.8 * 0.5), 0.1) << "white without them";
  EXPECT_FALSE(warns(scene, "COLOR_0"));
}

TEST(GltfVertexColors, OneMaterialServesMeshesWithAndWithout) {
  const SceneFolder folder;
  GltfBuilder gltf;
  gltf.square(", \"material\": 0");
  const int colors = gltf.accessor<std::uint8_t>({255, 51, 0, 255, 255, 51, 0, 255, 255, 51, 0, 255, 255, 51, 0, 128}, 4,
                                                 ", \"normalized\": true");
  gltf.add("meshes", "{\"primitives\": [{\"attributes\": {\"POSITION\": 0, \"COLOR_0\": " + std::to_string(colors) +
                         "}, \"indices\": 3, \"material\": 0}]}");
  gltf.add("nodes", R"({"mesh": 1, "translation": [3, 0, 0]})").add("materials", R"({"alphaMode": "BLEND"})");
  const SceneDescription scene = gltf.read(folder);
  EXPECT_FALSE(held<GltfDescription>(scene, 0)->vertex_colors);
  EXPECT_TRUE(held<GltfDescription>(scene, 1)->vertex_colors);
  EXPECT_EQ(std::get<MeshDescription>(scene.shapes[1].geometry).colors.at(0), (Rgb{1, 0.2f, 0}));
  EXPECT_TRUE(warns(scene, "meshes[1].primitives[0]: COLOR_0: alpha of vertices is not read"));
  EXPECT_NO_THROW(Scene(scene, 1));
}

// ---------------------------------------------------------------- bad input

void expect_material_error(const std::string& material, const std::string& part) {
  SCOPED_TRACE(material);
  const SceneFolder folder;
  GltfBuilder gltf;
  with_image(gltf.square(", \"material\": 0"), kUpPng).add("materials", material);
  const std::string error = error_of([&] { gltf.read(folder); });
  EXPECT_NE(error.find(part), std::string::npos) << error;
}

TEST(BadGltfSurface, MaterialsOutOfRangeAreErrors) {
  const auto volume = [](const std::string& members) {
    return R"({"extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_volume": {"thicknessFactor": 1, )" +
           members + "}}}";
  };
  expect_material_error(volume(R"("attenuationDistance": 0)"),
                        "materials[0].extensions.KHR_materials_volume.attenuationDistance: is 0");
  expect_material_error(volume(R"("attenuationDistance": 1e-300, "attenuationColor": [1, 0.5, 1])"), "the absorption is infinite");
  expect_material_error(volume(R"("attenuationDistance": 1, "attenuationColor": [1, 1.5, 1])"), "attenuationColor[1]: is 1.5");
  expect_material_error(R"({"alphaMode": "MASK", "alphaCutoff": -1})", "materials[0].alphaCutoff: is -1");
  expect_material_error(R"({"alphaMode": "MASK", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 2]}})",
                        "baseColorFactor[3]: is 2");
  expect_material_error(R"({"normalTexture": {"index": 0, "scale": "much"}})", "materials[0].normalTexture.scale: is the text");
  expect_material_error(R"({"normalTexture": {"index": 0, "scale": 1e300}})", "normalTexture.scale: is 1e+300, expected a smaller");
  expect_material_error(R"({"normalTexture": {"index": 7}})", "materials[0].normalTexture.index: is 7");
}

template <typename Component>
void expect_color_error(const std::vector<Component>& colors, int components, const std::string& part,
                        const std::string& extra = "") {
  const SceneFolder folder;
  GltfBuilder gltf;
  gltf.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  gltf.accessor(colors, components, extra);
  gltf.add("meshes", R"({"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 1}}]})").add("nodes", R"({"mesh": 0})");
  const std::string error = error_of([&] { gltf.read(folder); });
  EXPECT_NE(error.find(part), std::string::npos) << error;
}

TEST(BadGltfSurface, ColoursOfTheWrongKindAreErrors) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  expect_color_error<float>({0, 0, 0, 0, 0, 0}, 2, "accessors[1].type: is the text \"VEC2\", expected \"VEC3\" or \"VEC4\"");
  expect_color_error<float>({0, 0, 0, 0, 0, 0}, 3, "with 2 elements, expected as many as POSITION has: 3");
  expect_color_error<float>({0, 0, 0, 0, nan, 0, 0, 0, 0}, 3, "COLOR_0: is 1, whose vertex 1 has a value that is not a number");
  expect_color_error<std::uint8_t>({0, 0, 0, 0, 0, 0, 0, 0, 0}, 3, "accessors[1].normalized: is missing, expected true");
}

}  // namespace
}  // namespace fluxfarm
