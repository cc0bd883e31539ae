// glTF scenes: what comes out of the reader, against values worked out by hand.
#include <cmath>

#include "io/data_uri.h"
#include "io/describe.h"
#include "io/gltf_builder.h"

namespace fluxfarm {
namespace {

const GltfDescription& gltf_material(const SceneDescription& scene, std::size_t shape = 0) {
  return std::get<GltfDescription>(scene.materials.at(static_cast<std::size_t>(scene.shapes.at(shape).material)));
}

void expect_near(Vec3f actual, Vec3f expected, float tolerance = 1e-6f) {
  EXPECT_NEAR(length(actual - expected), 0, tolerance) << actual.x << " " << actual.y << " " << actual.z;
}

TEST(Gltf, BinaryTextAndDataUriGiveTheSameScene) {
  const SceneFolder folder;
  GltfBuilder gltf;
  gltf.square();
  const std::string text = Describer().describe(gltf.read(folder));
  folder.write("scene.glb", gltf.glb());
  std::string binary = Describer().describe(read_scene(folder.path(), "scene.glb", {}));
  while (binary.find("scene.glb") != std::string::npos) binary.replace(binary.find("scene.glb"), 9, "scene.gltf");
  EXPECT_EQ(text, binary);
  // The same bytes inside the document.
  GltfBuilder points;
  const int positions = points.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  points.add("meshes", "{\"primitives\": [{\"attributes\": {\"POSITION\": " + std::to_string(positions) + "}}]}");
  points.add("nodes", "{\"mesh\": 0}");
  folder.write("uri.gltf", points.document("\"uri\": \"data:application/octet-stream;base64,"
                                           "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\", "));
  const SceneDescription scene = read_scene(folder.path(), "uri.gltf", {});
  const auto& mesh = only_mesh(scene);
  ASSERT_EQ(mesh.positions.size(), 3u);
  expect_near(mesh.positions[1], {1, 0, 0});
  expect_near(mesh.positions[2], {0, 1, 0});
}

TEST(Gltf, NodesPlaceMeshesByMatrixAndByTranslationRotationScale) {
  const SceneFolder folder;
  GltfBuilder gltf;
  const double s = std::sqrt(0.5);
  // A quarter turn about z after a scale of 2 along x, under a parent that moves by (10, 0, 0).
  gltf.square("", ", \"rotation\": [0, 0, " + std::to_string(s) + ", " + std::to_string(s) +
                      "], \"scale\": [2, 1, 1], \"translation\": [0, 0, 5]");
  gltf.add("nodes", "{\"children\": [0], \"matrix\": [1,0,0,0, 0,1,0,0, 0,0,1,0, 10,0,0,1]}");
  const SceneDescription scene = gltf.read(folder);
  const auto& mesh = only_mesh(scene);
  expect_near(mesh.positions[1], {10, 2, 5}, 1e-5f);
  expect_near(mesh.positions[3], {9, 0, 5}, 1e-5f);
  expect_near(mesh.normals[0], {0, 0, 1});
}

TEST(Gltf, IndicesOfAllTypesStripsAndFansGiveTheSameSquare) {
  const SceneFolder folder;
  const auto area = [](const MeshDescription& mesh) {
    float sum = 0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      const Vec3f a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]],
                  c = mesh.positions[mesh.indices[i + 2]];
      sum += 0.5f * cross(b - a, c - a).z;  // signed: all must face +z
    }
    return sum;
  };
  const auto read = [&](auto index, std::vector<int> order, int mode) {
    GltfBuilder gltf;
    const int positions = gltf.accessor<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3);
    const int indices = gltf.accessor(std::vector<decltype(index)>(order.begin(), order.end()), 1);
    gltf.add("meshes", "{\"primitives\": [{\"mode\": " + std::to_string(mode) + ", \"attributes\": {\"POSITION\": " +
                           std::to_string(positions) + "}, \"indices\": " + std::to_string(indices) + "}]}");
    gltf.add("nodes", "{\"mesh\": 0}");
    return area(only_mesh(gltf.read(folder)));
  };
  EXPECT_FLOAT_EQ(read(std::uint8_t{}, {0, 1, 2, 0, 2, 3}, 4), 1);
  EXPECT_FLOAT_EQ(read(std::uint16_t{}, {0, 1, 2, 0, 2, 3}, 4), 1);
  EXPECT_FLOAT_EQ(read(std::uint32_t{}, {0, 1, 2, 0, 2, 3}, 4), 1);
  EXPECT_FLOAT_EQ(read(std::uint16_t{}, {0, 1, 3, 2}, 5), 1);
  EXPECT_FLOAT_EQ(read(std::uint16_t{}, {0, 1, 2, 3}, 6), 1);
  EXPECT_FLOAT_EQ(read(std::uint16_t{}, {0, 2, 1, 0, 3, 2}, 4), -1);  // the other way round
}

TEST(Gltf, QuantizedStridedAndSparseAccessorsAreDecoded) {
  const SceneFolder folder;
  GltfBuilder gltf;
  const int quantized = gltf.accessor<std::int16_t>({0, 0, 0, 32767, 0, 0, 0, -32768, 0}, 3, ", \"normalized\": true");
  gltf.add("meshes", "{\"primitives\": [{\"attributes\": {\"POSITION\": " + std::to_string(quantized) + "}}]}");
  // Elements of 12 bytes, 16 apart.
  const int view =
      gltf.bytes(std::string(4, '\0') +
                     std::string("\0\0\0\0\0\0\0\0\0\0\0\0PADD\0\0\0\x40\0\0\0\0\0\0\0\0PADD\0\0\0\0\0\0\0\x40\0\0\0\0", 44),
                 ", \"byteStride\": 16");
  const int strided = gltf.raw_accessor("\"bufferView\": " + std::to_string(view) +
                                        ", \"byteOffset\": 4, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\"");
  gltf.add("meshes", "{\"primitives\": [{\"attributes\": {\"POSITION\": " + std::to_string(strided) + "}}]}");
  // Zeros but for elements 1 and 2.
  const int where = gltf.bytes(std::string("\1\2", 2));
  const std::vector<float> values{3, 0, 0, 0, 4, 0};
  const int what = gltf.bytes(std::string(reinterpret_cast<const char*>(values.data()), 24));
  const int sparse = gltf.raw_accessor(
      "\"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\", \"sparse\": {\"count\": 2, \"indices\": "
      "{\"bufferView\": " +
      std::to_string(where) + ", \"componentType\": 5121}, \"values\": {\"bufferView\": " + std::to_string(what) + "}}");
  gltf.add("meshes", "{\"primitives\": [{\"attributes\": {\"POSITION\": " + std::to_string(sparse) + "}}]}");
  gltf.add("nodes", "{\"mesh\": 0}, {\"mesh\": 1}, {\"mesh\": 2}");
  gltf.more(", \"extensionsRequired\": [\"KHR_mesh_quantization\"]");
  const SceneDescription scene = gltf.read(folder);
  ASSERT_EQ(scene.shapes.size(), 3u);
  const auto position = [&](std::size_t shape, std::size_t i) {
    return std::get<MeshDescription>(scene.shapes[shape].geometry).positions[i];
  };
  expect_near(position(0, 1), {1, 0, 0});
  expect_near(position(0, 2), {0, -1, 0});  // -32768 is clamped
  expect_near(position(1, 1), {2, 0, 0});
  expect_near(position(1, 2), {0, 2, 0});
  expect_near(position(2, 0), {0, 0, 0});
  expect_near(position(2, 1), {3, 0, 0});
  expect_near(position(2, 2), {0, 4, 0});
}

TEST(Gltf, MeshWithoutNormalsIsFlatAndKeepsItsFrontUnderAMirror) {
  const SceneFolder folder;
  GltfBuilder gltf;
  const int positions = gltf.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  gltf.add("meshes", "{\"primitives\": [{\"attributes\": {\"POSITION\": " + std::to_string(positions) + "}}]}");
  gltf.add("nodes", "{\"mesh\": 0, \"scale\": [-1, 1, 1]}");
  const SceneDescription scene = gltf.read(folder);
  const auto& mesh = only_mesh(scene);
  EXPECT_TRUE(mesh.normals.empty());
  const Vec3f a = mesh.positions[mesh.indices[0]], b = mesh.positions[mesh.indices[1]], c = mesh.positions[mesh.indices[2]];
  EXPECT_GT(cross(b - a, c - a).z, 0);
}

TEST(Gltf, MeshOfSeveralNodesIsSharedAndALightIsNot) {
  const SceneFolder folder;
  GltfBuilder gltf;
  gltf.square();
  gltf.add("nodes", "{\"mesh\": 0, \"translation\": [5, 0, 0]}");
  const SceneDescription scene = gltf.read(folder);
  ASSERT_EQ(scene.shapes.size(), 2u);
  const auto& first = std::get<InstanceDescription>(scene.shapes[0].geometry);
  const auto& second = std::get<InstanceDescription>(scene.shapes[1].geometry);
  EXPECT_EQ(first.mesh, second.mesh);
  expect_near(second.to_world.point({0, 0, 0}), {5, 0, 0});
  expect_near(second.mesh->positions[0], {0, 0, 0});

  GltfBuilder lights;
  lights.square(", \"material\": 0");
  lights.add("nodes", "{\"mesh\": 0, \"translation\": [5, 0, 0]}");
  lights.add("materials",
             "{\"emissiveFactor\": [1, 0.5, 0.25], \"extensions\": {\"KHR_materials_emissive_strength\": "
             "{\"emissiveStrength\": 8}}, \"doubleSided\": true}");
  const SceneDescription shining = lights.read(folder);
  ASSERT_EQ(shining.shapes.size(), 2u);
  expect_near(std::get<MeshDescription>(shining.shapes[1].geometry).positions[0], {5, 0, 0});
  EXPECT_EQ(*shining.shapes[0].emitted_radiance, (Rgb{8, 4, 2}));
  EXPECT_TRUE(shining.shapes[0].emits_on_both_sides);
  EXPECT_FALSE(warns(shining, "no light"));
}

TEST(Gltf, GpuInstancesAreInstancesOfOneMesh) {
  const SceneFolder folder;
  GltfBuilder gltf;
  const int translation = gltf.accessor<float>({1, 0, 0, 2, 0, 0, 3, 0, 0}, 3);
  const int scale = gltf.accessor<float>({1, 1, 1, 2, 2, 2, 3, 3, 3}, 3);
  const int rotation = gltf.accessor<std::int8_t>({0, 0, 0, 127, 0, 0, 127, 0, 0, 0, 0, 127}, 4, ", \"normalized\": true");
  gltf.square("",
              ", \"translation\": [0, 7, 0], \"extensions\": {\"EXT_mesh_gpu_instancing\": {\"attributes\": {\"TRANSLATION\": " +
                  std::to_string(translation) + ", \"SCALE\": " + std::to_string(scale) +
                  ", \"ROTATION\": " + std::to_string(rotation) + "}}}");
  const SceneDescription scene = gltf.read(folder);
  ASSERT_EQ(scene.shapes.size(), 3u);
  const auto& second = std::get<InstanceDescription>(scene.shapes[1].geometry);
  EXPECT_EQ(second.mesh, std::get<InstanceDescription>(scene.shapes[2].geometry).mesh);
  expect_near(second.to_world.point({1, 0, 0}), {0, 7, 0}, 1e-5f);  // half a turn about z, twice as large, from (2, 7, 0)
}

TEST(Gltf, MaterialsKeepTheFactorsOfTheFile) {
  const SceneFolder folder;
  GltfBuilder gltf;
  gltf.square(", \"material\": 0");
  gltf.add("materials",
           R"({"pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 1], "metallicFactor": 0.4, "roughnessFactor": 0.6},
    "extensions": {"KHR_materials_ior": {"ior": 1.7}, "KHR_materials_specular": {"specularFactor": 0.8, "specularColorFactor": [1, 0.9, 2]},
    "KHR_materials_clearcoat": {"clearcoatFactor": 0.7, "clearcoatRoughnessFactor": 0.2}, "KHR_materials_sheen": {"sheenColorFactor":
    [0.3, 0.2, 0.1], "sheenRoughnessFactor": 0.5}, "KHR_materials_anisotropy": {"anisotropyStrength": 0.9, "anisotropyRotation": 1.5},
    "KHR_materials_transmission": {"transmissionFactor": 0.25}}})");
  const GltfDescription d = gltf_material(gltf.read(folder));
  EXPECT_EQ(d.base_color, (Rgb{0.1f, 0.2f, 0.3f}));
  EXPECT_FLOAT_EQ(d.metallic, 0.4f);
  EXPECT_FLOAT_EQ(d.roughness, 0.6f);
  EXPECT_FLOAT_EQ(d.ior, 1.7f);
  EXPECT_FLOAT_EQ(d.specular, 0.8f);
  EXPECT_EQ(d.specular_color, (Rgb{1, 0.9f, 2}));
  EXPECT_FLOAT_EQ(d.clearcoat, 0.7f);
  EXPECT_FLOAT_EQ(d.clearcoat_roughness, 0.2f);
  EXPECT_EQ(d.sheen_color, (Rgb{0.3f, 0.2f, 0.1f}));
  EXPECT_FLOAT_EQ(d.anisotropy, 0.9f);
  EXPECT_FLOAT_EQ(d.anisotropy_rotation, 1.5f);
  EXPECT_FLOAT_EQ(d.transmission, 0.25f);
  EXPECT_TRUE(d.thin);
}

TEST(Gltf, PrimitiveWithoutMaterialHasTheDefaultsOfGltf) {
  const SceneFolder folder;
  GltfBuilder gltf;
  const GltfDescription d = gltf_material(gltf.square().read(folder));
  EXPECT_EQ(d.base_color, Rgb{1});
  EXPECT_FLOAT_EQ(d.metallic, 1);
  EXPECT_FLOAT_EQ(d.roughness, 1);
}

TEST(Gltf, GlassWithAVolumeIsADielectric) {
  const SceneFolder folder;
  GltfBuilder gltf;
  gltf.square(", \"material\": 0");
  gltf.add("materials", R"({"pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.5}, "extensions":
    {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_volume": {"thicknessFactor": 0.1}}})");
  const SceneDescription scene = gltf.read(folder);
  const auto& glass = std::get<RoughDielectricDescription>(scene.materials.at(static_cast<std::size_t>(scene.shapes[0].material)));
  EXPECT_FLOAT_EQ(glass.dielectric.eta, 1.5f);
  EXPECT_FLOAT_EQ(glass.roughness.alpha_u, 0.25f);
  EXPECT_EQ(glass.roughness.distribution, MicrofacetDistribution::kGgx);
}

TEST(Gltf, ImagesComeFromFilesBuffersAndDataUris) {
  const SceneFolder folder;
  // A PNG of two texels: red, blue.
  const std::string base64 = "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAADUlEQVR4nGP4zwAE/wEHAAH/4iOeWQAAAABJRU5ErkJggg==";
  folder.write("parts/two texels.png", data_uri_bytes("data:image/png;base64," + base64, "test"));
  for (const char* source : {"uri", "file", "buffer"}) {
    GltfBuilder gltf;
    gltf.square(", \"material\": 0");
    gltf.add("materials", R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform":
      {"offset": [0.5, 0], "scale": [2, 1]}}}}})");
    gltf.add("textures", R"({"source": 0, "sampler": 0})")
        .add("samplers", R"({"magFilter": 9728, "wrapS": 33071, "wrapT": 33071})");
    if (source == std::string("uri")) {
      gltf.add("images", "{\"uri\": \"data:image/png;base64," + base64 + "\"}");
    } else if (source == std::string("file")) {
      gltf.add("images", R"({"uri": "parts/two%20texels.png"})");
    } else {
      const int view = gltf.bytes(data_uri_bytes("data:image/png;base64," + base64, "test"));
      gltf.add("images", "{\"mimeType\": \"image/png\", \"bufferView\": " + std::to_string(view) + "}");
    }
    const SceneDescription scene = gltf.read(folder);
    const int texture = gltf_material(scene).base_color_texture;
    ASSERT_NE(texture, kNoTexture) << source;
    const auto& bitmap = std::get<BitmapDescription>(scene.textures.at(static_cast<std::size_t>(texture)));
    EXPECT_EQ(bitmap.wrap, TextureWrap::kClamp);
    EXPECT_EQ(bitmap.filter, TextureFilter::kNearest);
    ASSERT_EQ(bitmap.image->width(), 2);
    EXPECT_EQ(bitmap.image->texel(0, 0), (Rgb{1, 0, 0}));
    EXPECT_EQ(bitmap.image->texel(1, 0), (Rgb{0, 0, 1}));
    expect_near(bitmap.to_uv.point({0.25f, 0.5f, 0}), {1, 0.5f, 0});
  }
}

TEST(Gltf, LightsShineAlongMinusZ) {
  const SceneFolder folder;
  GltfBuilder gltf;
  gltf.square();
  gltf.more(R"(, "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "color": [1, 0.5, 0], "intensity": 10},
    {"type": "spot", "intensity": 2, "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.5}}, {"type": "directional"}]}})");
  for (const char* light : {"0", "1", "2"})
    gltf.add("nodes",
             "{\"translation\": [1, 2, 3], \"extensions\": {\"KHR_lights_punctual\": {\"light\": " + std::string(light) + "}}}");
  const SceneDescription scene = gltf.read(folder);
  ASSERT_EQ(scene.emitters.size(), 3u);
  const auto& point = std::get<PointEmitterDescription>(scene.emitters[0]);
  expect_near(point.position, {1, 2, 3});
  EXPECT_EQ(point.intensity, (Rgb{10, 5, 0}));
  const auto& spot = std::get<SpotEmitterDescription>(scene.emitters[1]);
  expect_near(spot.axis, {0, 0, -1});
  EXPECT_NEAR(spot.cutoff_angle_degrees, 28.6479f, 1e-3);
  EXPECT_NEAR(spot.beam_width_degrees, 5.72958f, 1e-4);
  expect_near(std::get<DirectionalEmitterDescription>(scene.emitters[2]).direction, {0, 0, -1});
}

TEST(Gltf, CameraLooksAlongMinusZWithItsAspectRatio) {
  const SceneFolder folder;
  GltfBuilder gltf;
  gltf.square();
  gltf.add("cameras", R"({"type": "perspective", "perspective": {"yfov": 0.5, "aspectRatio": 2, "znear": 0.25}})");
  gltf.add("nodes", R"({"camera": 0, "translation": [0, 0, 4], "scale": [3, 3, 3]})");
  const SceneDescription scene = gltf.read(folder);
  expect_near(scene.camera.to_world.vector({0, 0, 1}), {0, 0, -1});
  expect_near(scene.camera.to_world.vector({1, 0, 0}), {-1, 0, 0});
  expect_near(scene.camera.to_world.point({0, 0, 0}), {0, 0, 4});
  EXPECT_NEAR(scene.camera.fov_degrees, 28.6479f, 1e-3);
  EXPECT_EQ(scene.film.width, 2 * scene.film.height);
  EXPECT_FLOAT_EQ(scene.camera.near_clip, 0.25f);
}

TEST(Gltf, FileWithoutCameraAndLightIsFramedAndLitAndSaysSo) {
  const SceneFolder folder;
  GltfBuilder gltf;
  gltf.square("", ", \"translation\": [100, 0, 0]");
  const SceneDescription scene = gltf.read(folder);
  EXPECT_TRUE(warns(scene, "no perspective camera"));
  EXPECT_TRUE(warns(scene, "no light: a constant white environment"));
  ASSERT_EQ(scene.emitters.size(), 1u);
  EXPECT_EQ(std::get<ConstantEmitterDescription>(scene.emitters[0]).radiance, Rgb{1});
  // Every corner of the square lies within the cone of the camera.
  const auto& m = scene.camera.to_world;
  const Vec3f eye = m.point({0, 0, 0}), axis = m.vector({0, 0, 1});
  for (const Vec3f& p : only_mesh(scene).positions) EXPECT_GT(dot(normalize(p - eye), axis), std::cos(20 * kPi / 180));
}

TEST(Gltf, StandsInsideAMitsubaSceneAsAShape) {
  const SceneFolder folder;
  GltfBuilder gltf;
  gltf.square();
  folder.write("models/a.glb", gltf.glb());
  const SceneDescription xml = folder.read_xml(
      "<shape type=\"gltf\"><string name=\"filename\" value=\"models/a.glb\"/><transform name=\"to_world\"><translate x=\"3\"/>"
      "</transform></shape>\n<shape type=\"sphere\"/>");
  ASSERT_EQ(xml.shapes.size(), 2u);
  expect_near(std::get<MeshDescription>(xml.shapes[0].geometry).positions[0], {3, 0, 0});
  EXPECT_EQ(xml.emitters.size(), 1u);  // that of the XML, no environment of our own
  EXPECT_NE(xml.shapes[0].material, xml.shapes[1].material);
  const SceneDescription json =
      folder.read_json(R"({"type": "scene", "camera": {"type": "perspective"}, "sky": {"type": "constant"},
    "model": {"type": "gltf", "filename": "models/a.glb"}})");
  EXPECT_EQ(json.shapes.size(), 1u);
}

TEST(Gltf, WhatIsNotReadIsAWarning) {
  const SceneFolder folder;
  GltfBuilder gltf;
  gltf.square(", \"material\": 0, \"targets\": []");
  gltf.add("materials", R"({"extensions": {"KHR_materials_unlit": {}}})");
  gltf.add("nodes", R"({"mesh": 0, "scale": [0, 0, 0]})").add("animations", "{}");
  gltf.more(R"(, "extensionsUsed": ["KHR_materials_unlit", "VENDOR_sparkle"])");
  const SceneDescription scene = gltf.read(folder);
  for (const char* text :
       {"VENDOR_sparkle", "KHR_materials_unlit: the surface", "scaled to nothing", "animations", "morph targets"}) {
    EXPECT_TRUE(warns(scene, text)) << text;
  }
}

}  // namespace
}  // namespace fluxfarm
