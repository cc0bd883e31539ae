// Malformed and hostile glTF: each gives one error that names the place, and nothing crashes or takes memory that the file does not
// have.
#include <limits>

#include "io/gltf_builder.h"

namespace fluxfarm {
namespace {

std::string error_of_builder(const GltfBuilder& gltf) {
  const SceneFolder folder;
  return error_of([&] { gltf.read(folder); });
}

std::string error_of_text(const std::string& text, const char* name = "scene.gltf") {
  const SceneFolder folder;
  folder.write(name, text);
  return error_of([&] { read_scene(folder.path(), name, {}); });
}

// A mesh of one accessor that `members` describe, over 36 bytes.
std::string error_of_accessor(const std::string& members) {
  GltfBuilder gltf;
  gltf.bytes(std::string(36, '\0'));
  gltf.raw_accessor(members);
  gltf.add("meshes", R"({"primitives": [{"attributes": {"POSITION": 0}}]})").add("nodes", R"({"mesh": 0})");
  return error_of_builder(gltf);
}

void expect_part(const std::string& error, const std::string& part) {
  EXPECT_NE(error.find(part), std::string::npos) << error << "\n  lacks: " << part;
}

TEST(BadGltf, LyingAccessorsAreErrors) {
  expect_part(error_of_accessor(R"("bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3")"),
              "scene.gltf: accessors[0].bufferView: is 0, which has 36 bytes, too few for 4 elements of 12 bytes");
  expect_part(error_of_accessor(R"("bufferView": 0, "componentType": 5126, "count": 1099511627776, "type": "VEC3")"),
              "accessors[0].count: is 1099511627776, expected an integer in [0, 268435456]");
  expect_part(error_of_accessor(R"("bufferView": 0, "componentType": 5126, "count": 200000000, "type": "VEC3")"),
              "accessors[0].count");
  expect_part(error_of_accessor(R"("componentType": 5126, "count": 200000000, "type": "VEC3")"), "without a bufferView");
  expect_part(error_of_accessor(R"("bufferView": 0, "byteOffset": 4, "componentType": 5126, "count": 3, "type": "VEC3")"),
              "from byte 4 on");
  expect_part(error_of_accessor(R"("bufferView": 7, "componentType": 5126, "count": 3, "type": "VEC3")"),
              "accessors[0].bufferView: is 7, expected an index into bufferViews, which has 1 elements");
  expect_part(error_of_accessor(R"("bufferView": 0, "componentType": 5127, "count": 3, "type": "VEC3")"), "componentType: is 5127");
  expect_part(error_of_accessor(R"("bufferView": 0, "componentType": 5126, "count": -3, "type": "VEC3")"), "count: is -3");
  expect_part(error_of_accessor(R"("bufferView": 0, "componentType": 5126, "count": 3, "type": "MAT4")"),
              "type: is the text \"MAT4\"");
  expect_part(error_of_accessor(R"("bufferView": 0, "componentType": 5126, "type": "VEC3")"), "count: is missing");
}

TEST(BadGltf, TruncatedFilesAreErrors) {
  GltfBuilder gltf;
  gltf.square();
  const std::string whole = gltf.glb();
  // Every length that is too short is an error with a place, whatever part is cut.
  for (std::size_t size = 0; size < whole.size(); size += size < 64 ? 1 : 37) {
    SCOPED_TRACE(size);
    expect_part(error_of_text(whole.substr(0, size), "scene.glb"), "scene.glb");
  }
  expect_part(error_of_text(whole.substr(0, whole.size() - 4), "scene.glb"), "is cut off: it has");
  std::string lying = whole;
  lying.replace(12, 4, GltfBuilder::word(0xfffffff0u));
  expect_part(error_of_text(lying, "scene.glb"), "chunk 0 has 4294967280 bytes, but only");
  std::string old = whole;
  old.replace(4, 4, GltfBuilder::word(1));
  expect_part(error_of_text(old, "scene.glb"), "binary glTF of version 1, expected 2");
  const SceneFolder folder;
  folder.write("scene.gltf", gltf.document("\"uri\": \"short.bin\", "));
  folder.write("short.bin", gltf.binary().substr(0, 40));
  expect_part(error_of([&] { read_scene(folder.path(), "scene.gltf", {}); }), "buffers[0].byteLength");
}

TEST(BadGltf, MissingAndForeignFilesAreErrors) {
  GltfBuilder gltf;
  gltf.square();
  expect_part(error_of_text(gltf.document("\"uri\": \"gone.bin\", ")), "buffers[0].uri: file \"gone.bin\" does not exist");
  expect_part(error_of_text(gltf.document("\"uri\": \"../../etc/passwd\", ")), "lies outside the scene's folder");
  expect_part(error_of_text(gltf.document("\"uri\": \"%2e%2e/%2e%2e/etc/passwd\", ")), "lies outside the scene's folder");
  expect_part(error_of_text(gltf.document("\"uri\": \"http://example.org/a.bin\", ")),
              "expected the name of a file beside this one");
  expect_part(error_of_text(gltf.document("\"uri\": \"data:;base64,A!A\", ")), "expected base64");
  expect_part(error_of_text(gltf.document("")), "no binary chunk");
  gltf.add("images", R"({"uri": "gone.png"})").add("textures", R"({"source": 0})");
  GltfBuilder textured;
  textured.square(", \"material\": 0");
  textured.add("images", R"({"uri": "gone.png"})").add("textures", R"({"source": 0})");
  textured.add("materials", R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}})");
  expect_part(error_of_builder(textured), "scene.gltf: images[0].uri: file \"gone.png\" does not exist");
  GltfBuilder damaged;
  damaged.square(", \"material\": 0");
  damaged.add("images", R"({"uri": "data:image/png;base64,iVBORw0KGgo="})").add("textures", R"({"source": 0})");
  damaged.add("materials", R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}})");
  expect_part(error_of_builder(damaged), "images[0]: is a damaged png image");
}

TEST(BadGltf, CyclicAndSharedNodesAreErrors) {
  GltfBuilder cycle;
  cycle.square("", ", \"children\": [1]");
  cycle.add("nodes", R"({"children": [0]})").add("scenes", R"({"nodes": [0]})");
  expect_part(error_of_builder(cycle), "nodes[0]: is reached twice");
  GltfBuilder self;
  self.square("", ", \"children\": [0]").add("scenes", R"({"nodes": [0]})");
  expect_part(error_of_builder(self), "nodes[0]: is reached twice");
  GltfBuilder diamond;
  diamond.square().add("nodes", R"({"children": [0]})").add("nodes", R"({"children": [0]})");
  expect_part(error_of_builder(diamond), "nodes[0]: is reached twice");
  GltfBuilder deep;
  deep.square();
  for (int i = 0; i < 2000; ++i) deep.add("nodes", "{\"children\": [" + std::to_string(i) + "]}");
  expect_part(error_of_builder(deep), "lies more than 1024 nodes deep");
}

TEST(BadGltf, TooManyInstancesAreAnErrorBeforeAnythingIsRead) {
  GltfBuilder gltf;
  gltf.bytes(std::string(12, '\0'));
  const int many = gltf.raw_accessor(R"("bufferView": 0, "componentType": 5126, "count": 100000000, "type": "VEC3")");
  gltf.square("",
              ", \"extensions\": {\"EXT_mesh_gpu_instancing\": {\"attributes\": {\"TRANSLATION\": " + std::to_string(many) + "}}}");
  expect_part(error_of_builder(gltf), "places 100000000 instances, expected at most 1048576");
}

TEST(BadGltf, NumbersThatAreNoneAreErrors) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  GltfBuilder positions;
  positions.accessor<float>({0, 0, 0, nan, 0, 0, 0, 1, 0}, 3);
  positions.add("meshes", R"({"primitives": [{"attributes": {"POSITION": 0}}]})").add("nodes", R"({"mesh": 0})");
  expect_part(error_of_builder(positions), "scene.gltf: meshes[0].primitives[0]: vertex 1 is (nan, 0, 0)");
  GltfBuilder indices;
  indices.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  indices.accessor<std::uint32_t>({0, 1, 3}, 1);
  indices.add("meshes", R"({"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]})").add("nodes", R"({"mesh": 0})");
  expect_part(error_of_builder(indices), "triangle 0 refers to vertex 3, expected an index below 3");
  GltfBuilder normals;
  normals.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  normals.accessor<float>({0, 0, 1, 0, 0, 1}, 3);
  normals.add("meshes", R"({"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}}]})").add("nodes", R"({"mesh": 0})");
  expect_part(error_of_builder(normals), "expected as many as POSITION has: 3");
  GltfBuilder far;
  far.square("", R"(, "scale": [1e300, 1e300, 1e300], "children": [1])").add("nodes", R"({"scale": [1e300, 1, 1]})");
  expect_part(error_of_builder(far), "finite");
  const auto node = [](const char* members) {
    GltfBuilder gltf;
    gltf.square("", members);
    return error_of_builder(gltf);
  };
  expect_part(node(R"(, "rotation": [0, 0, 0, 0])"), "nodes[0].rotation");
  expect_part(node(R"(, "scale": [1, 2])"), "nodes[0].scale: is an array of 2 elements, expected 3 numbers");
  expect_part(node(R"(, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,2])"), "nodes[0].matrix");
  expect_part(node(R"(, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "scale": [1, 1, 1])"), "expected one or the other");
}

TEST(BadGltf, WrongDocumentsAreErrors) {
  expect_part(error_of_text("{\"asset\": "), "is not JSON");
  expect_part(error_of_text("[]"), "is an array of 0 elements, expected an object");
  expect_part(error_of_text("{}"), "asset: is missing");
  expect_part(error_of_text(R"({"asset": {"version": "1.0"}})"), "asset.version: is the text \"1.0\", expected \"2.0\"");
  expect_part(error_of_text(R"({"asset": {"version": "2.0"}})"), "has no mesh to show");
  expect_part(error_of_text(R"({"asset": {"version": "2.0"}, "nodes": 3})"), "nodes: is 3, expected an array");
  expect_part(error_of_text(R"({"asset": {"version": "2.0"}, "extensionsRequired": ["KHR_draco_mesh_compression"]})"),
              "the file requires \"KHR_draco_mesh_compression\", which is not read");
  expect_part(error_of_text(std::string(100, '[')), "nested deeper than 64 levels");
}

TEST(BadGltf, MaterialsLightsAndCamerasOutOfRangeAreErrors) {
  const auto material = [](const std::string& text) {
    GltfBuilder gltf;
    gltf.square(", \"material\": 0").add("materials", text);
    return error_of_builder(gltf);
  };
  expect_part(material(R"({"pbrMetallicRoughness": {"metallicFactor": 2}})"), "metallicFactor: is 2, expected a number in [0, 1]");
  expect_part(material(R"({"pbrMetallicRoughness": {"roughnessFactor": "high"}})"), "is the text \"high\"");
  expect_part(material(R"({"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 2, 1]}})"), "baseColorFactor[2]: is 2");
  expect_part(material(R"({"emissiveFactor": [-1, 0, 0]})"), "emissiveFactor[0]: is -1");
  expect_part(material(R"({"alphaMode": "SOMETIMES"})"), "expected OPAQUE, MASK or BLEND");
  expect_part(material(R"({"extensions": {"KHR_materials_ior": {"ior": 0.5}}})"), "expected 0 or a number of at least 1");
  for (const char* member : {"clearcoat\": {\"clearcoatFactor\": 2}", "sheen\": {\"sheenRoughnessFactor\": -1}",
                             "anisotropy\": {\"anisotropyStrength\": 3}", "transmission\": {\"transmissionFactor\": 1.5}",
                             "specular\": {\"specularFactor\": -1}", "emissive_strength\": 4"}) {
    const std::string emits = std::string(member).find("emissive") == 0 ? "\"emissiveFactor\": [1, 1, 1], " : "";
    expect_part(material("{" + emits + "\"extensions\": {\"KHR_materials_" + member + "}}"), "extensions.KHR_materials_");
  }
  const auto light = [](const std::string& text) {
    GltfBuilder gltf;
    gltf.square("", ", \"extensions\": {\"KHR_lights_punctual\": {\"light\": 0}}");
    gltf.more(", \"extensions\": {\"KHR_lights_punctual\": {\"lights\": [" + text + "]}}");
    return error_of_builder(gltf);
  };
  expect_part(light(R"({"type": "area"})"), "expected point, spot or directional");
  expect_part(light(R"({"type": "point", "intensity": -1})"), "lights[0].intensity: is -1");
  expect_part(light(R"({"type": "spot", "spot": {"innerConeAngle": 0.9}})"), "expected less than outerConeAngle");
  expect_part(light(R"({"type": "spot"})"), "lights[0].spot: is missing");
  expect_part(light(""), "light: is 0, expected an index into lights, which has 0 elements");
  const auto camera = [](const std::string& text) {
    GltfBuilder gltf;
    gltf.square("", ", \"camera\": 0").add("cameras", text);
    return error_of_builder(gltf);
  };
  expect_part(camera(R"({"type": "perspective", "perspective": {"znear": 1}})"), "yfov: is missing");
  expect_part(camera(R"({"type": "perspective", "perspective": {"yfov": 4, "znear": 1}})"), "yfov: is 4");
  expect_part(camera(R"({"type": "perspective", "perspective": {"yfov": 1, "znear": 0}})"), "znear: is 0");
  expect_part(camera(R"({"type": "fisheye"})"), "expected perspective or orthographic");
}

TEST(BadGltf, NodeOfAMitsubaSceneNamesItsPlace) {
  const SceneFolder folder;
  EXPECT_EQ(error_of([&] { folder.read_xml("<shape type=\"gltf\"/>"); }),
            "scene.xml:2: shape \"gltf\": lacks the parameter \"filename\"");
  expect_part(error_of([&] { folder.read_xml("<shape type=\"gltf\"><string name=\"filename\" value=\"a.glb\"/></shape>"); }),
              "scene.xml:2: file \"a.glb\" does not exist");
  expect_part(error_of([&] { folder.read_xml("<shape type=\"gltf\"><integer name=\"lod\" value=\"1\"/></shape>"); }),
              "scene.xml:2");
}

}  // namespace
}  // namespace fluxfarm
