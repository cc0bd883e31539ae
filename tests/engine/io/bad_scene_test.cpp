// Malformed and hostile scene files: each gives one error that names the place.
#include "io/scene_folder.h"

namespace fluxfarm {
namespace {

std::string repeated(const std::string& text, int times) {
  std::string result;
  for (int i = 0; i < times; ++i) result += text;
  return result;
}

TEST(BadScene, MalformedXmlNamesTheLine) {
  const SceneFolder folder;
  EXPECT_EQ(error_of([&] { folder.read_xml("<shape type=\"sphere\">\n</shap>"); }),
            "scene.xml:3: is not well-formed XML: Start-end tags mismatch");
}

TEST(BadScene, MalformedJsonNamesLineAndColumn) {
  const SceneFolder folder;
  const std::string error = error_of([&] { folder.read_json("{\"type\": \"scene\",\n \"a\": nope}"); });
  EXPECT_EQ(error.find("scene.json:2: column 8: is not JSON: "), 0u) << error;
  EXPECT_NE(error_of([&] { folder.read_json("{\"type\": \"scene\", \"a\": NaN}"); }).find("is not JSON"), std::string::npos);
  EXPECT_NE(error_of([&] { folder.read_json("{\"type\": \"scene\""); }).find("is not JSON"), std::string::npos);
  EXPECT_NE(error_of([&] { folder.read_json("{\"type\": \"scene\", \"a\": 1e999}"); }).find("is not JSON"), std::string::npos);
  EXPECT_NE(error_of([&] { folder.read_json(""); }).find("is not JSON"), std::string::npos);
}

TEST(BadScene, MessagesAreValidTextWhateverTheFileHolds) {
  const SceneFolder folder;
  EXPECT_EQ(error_of([&] { folder.read_xml("<shape type=\"\xff\xfe\"/>"); }), "scene.xml: is not UTF-8 text");
  folder.write("a.obj", "v 0 0 \xc3\x28\x01\n");
  EXPECT_EQ(error_of([&] { folder.read_xml("<shape type=\"obj\"><string name=\"filename\" value=\"a.obj\"/></shape>"); }),
            "a.obj:1: \"?(?\", expected a finite number");
  const std::string error = error_of([&] { folder.read_json("{\"a\xff\": 1}"); });
  EXPECT_NE(error.find("is not JSON"), std::string::npos);
  EXPECT_EQ(error.find('\xff'), std::string::npos);
  EXPECT_NE(error_of([&] { folder.read_xml("<string name=\"\u00fc\" value=\"1\"/>"); }).find("\"\u00fc\""), std::string::npos);
}

TEST(BadScene, JsonMemberThatOccursTwiceIsAnError) {
  const SceneFolder folder;
  EXPECT_EQ(error_of([&] { folder.read_json(R"({"type": "scene", "s": {"type": "sphere", "radius": 1, "radius": 2}})"); }),
            "scene.json: s.radius: the member occurs twice");
}

TEST(BadScene, UnknownPluginsAreErrors) {
  const SceneFolder folder;
  EXPECT_EQ(error_of([&] { folder.read_xml("<shape type=\"sphere\">\n<bsdf type=\"velvet\"/></shape>"); }),
            "scene.xml:3: unknown plugin: bsdf \"velvet\", expected one of: diffuse, twosided, dielectric, roughdielectric, "
            "conductor, "
            "roughconductor, plastic, roughplastic, principled, thindielectric, null, mask, blendbsdf, normalmap, bumpmap");
  EXPECT_EQ(error_of([&] { folder.read_xml("<volume type=\"gridvolume\"/>"); }),
            "scene.xml:2: unknown plugin: volume \"gridvolume\"; no volume is supported yet");
  EXPECT_EQ(
      error_of([&] { folder.read_xml("<integrator type=\"bdpt\"/>"); }),
      "scene.xml:2: unknown plugin: integrator \"bdpt\", expected one of: path, photon, photon-progressive, irradiance-cache, "
      "volpath, volpathmis");
  EXPECT_EQ(error_of([&] { folder.read_xml("<shape type=\"diffuse\"/>"); }).find("scene.xml:2: unknown plugin: shape \"diffuse\""),
            0u);
  EXPECT_EQ(error_of([&] {
              folder.read_json(R"({"type": "scene", "m": {"type": "velvet"}})");
            }).find("scene.json: m: unknown plugin \"velvet\""),
            0u);
}

TEST(BadScene, UnknownParametersAndElementsAreErrors) {
  const SceneFolder folder;
  EXPECT_EQ(error_of([&] { folder.read_xml("<bsdf type=\"diffuse\"><rgb name=\"reflectence\" value=\"1\"/></bsdf>"); }),
            "scene.xml:2: bsdf \"diffuse\" has no parameter \"reflectence\"; it takes reflectance");
  EXPECT_EQ(error_of([&] { folder.read_json(R"({"type": "scene", "m": {"type": "diffuse", "colour": 1}})"); }),
            "scene.json: m.colour: bsdf \"diffuse\" has no parameter \"colour\"; it takes reflectance");
  EXPECT_EQ(error_of([&] { folder.read_xml("<teapot/>"); }), "scene.xml:2: unknown element <teapot> in scene \"scene\"");
  EXPECT_EQ(error_of([&] { folder.read_xml("<shape type=\"sphere\" colour=\"red\"/>"); }),
            "scene.xml:2: <shape> has no attribute \"colour\"; it takes type, id, name, version");
  EXPECT_EQ(error_of([&] { folder.read_xml("<shape type=\"sphere\"><film type=\"hdrfilm\"/></shape>"); }),
            "scene.xml:2: shape \"sphere\" cannot hold a film \"hdrfilm\"; it takes one bsdf, one emitter and two media");
  EXPECT_EQ(error_of([&] { folder.read_xml("hello"); }),
            "scene.xml:2: text \"hello\" between the elements, expected only elements");
}

TEST(BadScene, WrongValuesNameThemselvesAndWhatIsRight) {
  const SceneFolder folder;
  const auto sphere = [&](const std::string& property) {
    return error_of([&] { folder.read_xml("<shape type=\"sphere\">\n" + property + "</shape>"); });
  };
  EXPECT_EQ(sphere("<float name=\"radius\" value=\"big\"/>"), "scene.xml:3: <float> value = \"big\", expected a finite number");
  EXPECT_EQ(sphere("<float name=\"radius\" value=\"nan\"/>"), "scene.xml:3: <float> value = \"nan\", expected a finite number");
  EXPECT_EQ(sphere("<float name=\"radius\" value=\"-1\"/>"),
            "scene.xml:3: shape \"sphere\": radius = -1, expected a number greater than 0");
  EXPECT_EQ(sphere("<string name=\"radius\" value=\"1\"/>"),
            "scene.xml:3: shape \"sphere\": radius = \"1\", expected a number greater than 0");
  EXPECT_EQ(sphere("<float name=\"radius\" value=\"1\"/><float name=\"radius\" value=\"1\"/>"),
            "scene.xml:3: shape \"sphere\" has the parameter \"radius\" twice");
  EXPECT_EQ(sphere("<transform name=\"to_world\"><scale x=\"2\"/></transform>"),
            "scene.xml:3: shape \"sphere\": to_world = a transform, stretches or shears the sphere, expected the same scale, "
            "not 0, on all axes");
  EXPECT_EQ(sphere("<transform name=\"to_world\"><matrix value=\"1 2 3\"/></transform>"),
            "scene.xml:3: a matrix has 3 numbers, expected 16 or 9");
  EXPECT_EQ(sphere("<transform name=\"to_world\"><rotate angle=\"3\"/></transform>"),
            "scene.xml:3: the axis of a rotation is 0 0 0, expected a direction");
  EXPECT_EQ(sphere("<transform name=\"to_world\"><lookat origin=\"0 0 0\" target=\"0 1 0\" up=\"0 1 0\"/></transform>"),
            "scene.xml:3: lookat gives no direction: target equals origin, or up points along the view");
}

TEST(BadScene, MissingFileIsNamedWithThePlaceThatAsksForIt) {
  const SceneFolder folder;
  EXPECT_EQ(error_of([&] { folder.read_xml("<shape type=\"obj\"><string name=\"filename\" value=\"no such.obj\"/></shape>"); }),
            "scene.xml:2: file \"no such.obj\" does not exist in the scene's folder");
  EXPECT_EQ(error_of([&] { read_scene(folder.path(), "nothing.xml"); }),
            "scene: file \"nothing.xml\" does not exist in the scene's folder");
  EXPECT_EQ(error_of([&] { folder.read_xml("<shape type=\"obj\"/>"); }),
            "scene.xml:2: shape \"obj\": lacks the parameter \"filename\"");
  folder.write("scene.blend", "");
  EXPECT_EQ(error_of([&] { read_scene(folder.path(), "scene.blend"); }),
            "scene.blend: has the extension \".blend\", expected .xml, .json, .glb or .gltf");
}

TEST(BadScene, PathsThatLeaveTheFolderAreNotOpened) {
  const SceneFolder folder;
  folder.write("secret.obj", "v 0 0 0\n");
  folder.write("scene/sub/x.obj", "v 0 0 0\n");
  std::filesystem::create_symlink(folder.path() / "secret.obj", folder.path() / "scene/link.obj");
  for (const std::string name : {"../secret.obj", "sub/../../secret.obj", "/etc/passwd", "link.obj"}) {
    folder.write("scene/scene.xml",
                 "<scene version=\"3.0.0\"><shape type=\"obj\"><string name=\"filename\" value=\"" + name + "\"/></shape></scene>");
    EXPECT_EQ(error_of([&] { read_scene(folder.path() / "scene", "scene.xml"); }),
              "scene.xml:1: file \"" + name + "\" lies outside the scene's folder; copy it into the folder");
  }
  EXPECT_NE(error_of([&] { read_scene(folder.path() / "scene", "../secret.obj"); }).find("lies outside"), std::string::npos);
}

TEST(BadScene, DirectoriesAreNotOpenedAsFiles) {
  const SceneFolder folder;
  folder.write("models/x.obj", "");
  EXPECT_EQ(error_of([&] { folder.read_xml("<shape type=\"obj\"><string name=\"filename\" value=\"models\"/></shape>"); }),
            "scene.xml:2: \"models\" is not a plain file");
}

TEST(BadScene, NoSensorIsAnError) {
  const SceneFolder folder;
  EXPECT_EQ(error_of([&] { folder.read_whole_xml("<scene version=\"3.0.0\"/>"); }),
            "scene.xml:1: the scene has no sensor, expected one, as in <sensor type=\"perspective\">");
  EXPECT_EQ(error_of([&] { folder.read_json("{\"type\": \"scene\"}"); }).find("scene.json: the scene has no sensor"), 0u);
}

TEST(BadScene, NoLightAndSecondSensorAreWarnings) {
  const SceneFolder folder;
  const SceneDescription scene =
      folder.read_whole_xml("<scene version=\"3.0.0\"><sensor type=\"perspective\"/>\n<sensor type=\"perspective\"/></scene>");
  ASSERT_EQ(scene.warnings.size(), 2u);
  EXPECT_EQ(scene.warnings[0], "scene.xml:2: the scene has more than one sensor; the one at scene.xml:1 is used");
  EXPECT_EQ(scene.warnings[1], "scene.xml:1: no light: the image will be black");
}

TEST(BadScene, ImagesWithoutPixelsOrWithTooManyAreErrors) {
  const SceneFolder folder;
  const auto film = [&](const std::string& width, const std::string& height, const std::string& more = "") {
    return error_of([&] {
      folder.read_whole_xml(
          "<scene version=\"3.0.0\"><sensor type=\"perspective\"><film type=\"hdrfilm\"><integer name=\"width\" value=\"" + width +
          "\"/>\n<integer name=\"height\" value=\"" + height + "\"/>" + more + "</film></sensor></scene>");
    });
  };
  EXPECT_EQ(film("0", "5"), "scene.xml:1: film \"hdrfilm\": width = 0, expected an integer in [1, 65536]");
  EXPECT_EQ(film("5", "-1"), "scene.xml:2: film \"hdrfilm\": height = -1, expected an integer in [1, 65536]");
  EXPECT_EQ(film("1000000", "1000000"), "scene.xml:1: film \"hdrfilm\": width = 1000000, expected an integer in [1, 65536]");
  EXPECT_EQ(film("60000", "60000"),
            "scene.xml:1: film \"hdrfilm\": width = 60000, height = 60000: 3600000000 pixels, expected at most 134217728");
  EXPECT_EQ(film("1.5", "5"), "scene.xml:1: <integer> value = \"1.5\", expected an integer");
  EXPECT_EQ(film("10", "10", "<integer name=\"crop_offset_x\" value=\"4\"/><integer name=\"crop_width\" value=\"7\"/>"),
            "scene.xml:2: film \"hdrfilm\": crop_width = 7, the crop window ends at pixel 11, expected at most 10");
}

TEST(BadScene, NegativeSampleCountIsAnError) {
  const SceneFolder folder;
  EXPECT_EQ(error_of([&] {
              folder.read_whole_xml(
                  "<scene version=\"3.0.0\"><sensor type=\"perspective\"><sampler type=\"independent\">"
                  "<integer name=\"sample_count\" value=\"-4\"/></sampler></sensor></scene>");
            }),
            "scene.xml:1: sampler \"independent\": sample_count = -4, expected an integer in [1, 2.147484e+09]");
}

TEST(BadScene, NestingOfAHundredThousandLevelsIsOneError) {
  const SceneFolder folder;
  constexpr int kLevels = 100000;
  EXPECT_EQ(error_of([&] { folder.read_xml(repeated("<bsdf type=\"twosided\">", kLevels) + repeated("</bsdf>", kLevels)); }),
            "scene.xml:2: elements are nested deeper than 64 levels");
  const std::string objects = repeated("{\"a\":", kLevels) + "1" + repeated("}", kLevels);
  EXPECT_EQ(error_of([&] { folder.read_json(objects); }),
            "scene.json: a.a.a.a.a.a...: objects and arrays are nested deeper than 64 levels");
  const std::string arrays = repeated("[", kLevels) + repeated("]", kLevels);
  EXPECT_EQ(error_of([&] { folder.read_json(arrays); }),
            "scene.json: [0][0][0][0][0][0]...: objects and arrays are nested deeper than 64 levels");
}

TEST(BadScene, EntityDefinitionsAreRefused) {
  const SceneFolder folder;
  EXPECT_EQ(error_of([&] {
              folder.read_whole_xml(
                  "<?xml version=\"1.0\"?>\n<!DOCTYPE lolz [<!ENTITY a \"ha\"><!ENTITY b \"&a;&a;&a;\">]>\n<scene "
                  "version=\"3.0.0\"/>");
            }),
            "scene.xml:2: a DOCTYPE is not allowed: scenes define no entities, use <default> instead");
}

TEST(BadScene, DefaultsThatGrowExponentiallyAreStopped) {
  const SceneFolder folder;
  std::string body = "<default name=\"a0\" value=\"0123456789\"/>";
  for (int i = 1; i < 60; ++i) {
    const std::string before = "$a" + std::to_string(i - 1);
    body += "<default name=\"a" + std::to_string(i) + "\" value=\"" + before + " " + before + "\"/>";
  }
  EXPECT_EQ(error_of([&] { folder.read_xml(body); }).find("scene.xml:2: an attribute grows too long by $a"), 0u);
}

}  // namespace
}  // namespace fluxfarm
