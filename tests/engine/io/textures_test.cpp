// Texture plugins: parameters, nesting and references, in XML and JSON.
#include <gtest/gtest.h>

#include "io/exr.h"
#include "scene_folder.h"

namespace fluxfarm {
namespace {

class TextureScenes : public testing::Test {
 protected:
  TextureScenes() {
    Image image;
    image.width = image.height = 1;
    image.data_window = {0, 0, 1, 1};
    image.channels = {{"B", {0.1f}}, {"G", {0.2f}}, {"R", {0.3f}}};
    write_exr(folder_.path() / "a.exr", image);
    folder_.write("bad.exr", "not an image");
  }

  // A sphere of that bsdf.
  SceneDescription read(const std::string& bsdf, const std::string& before = "") const {
    return folder_.read_xml(before + "<shape type=\"sphere\">" + bsdf + "</shape>");
  }
  std::string error(const std::string& bsdf, const std::string& before = "") const {
    return error_of([&] { read(bsdf, before); });
  }
  static std::string bitmap(const std::string& name, const std::string& more = "") {
    return "<texture type=\"bitmap\" name=\"" + name + "\"><string name=\"filename\" value=\"a.exr\"/>" + more + "</texture>";
  }

  SceneFolder folder_;
};

TEST_F(TextureScenes, ABitmapHasMitsubasDefaults) {
  const SceneDescription scene = read("<bsdf type=\"diffuse\">" + bitmap("reflectance") + "</bsdf>");
  const auto& diffuse = std::get<DiffuseDescription>(scene.materials.at(0));
  EXPECT_EQ(diffuse.reflectance_texture, 0);
  EXPECT_EQ(diffuse.reflectance, Rgb(1)) << "a factor of the texture";
  const auto& texture = std::get<BitmapDescription>(scene.textures.at(0));
  EXPECT_EQ(texture.filter, TextureFilter::kBilinear);
  EXPECT_EQ(texture.wrap, TextureWrap::kRepeat);
  EXPECT_EQ(texture.image->texel(0, 0), Rgb(0.3f, 0.2f, 0.1f));
}

TEST_F(TextureScenes, ParametersAreRead) {
  const SceneDescription scene = read(
      "<bsdf type=\"diffuse\">" +
      bitmap("reflectance",
             "<string name=\"filter_type\" value=\"nearest\"/><string name=\"wrap_mode\" value=\"mirror\"/><boolean name=\"raw\" "
             "value=\"true\"/><transform name=\"to_uv\"><scale x=\"3\"/><translate y=\"0.5\"/></transform>") +
      "</bsdf>");
  const auto& texture = std::get<BitmapDescription>(scene.textures.at(0));
  EXPECT_EQ(texture.filter, TextureFilter::kNearest);
  EXPECT_EQ(texture.wrap, TextureWrap::kMirror);
  EXPECT_EQ(texture.to_uv.matrix()[0][0], 3);
  EXPECT_EQ(texture.to_uv.matrix()[1][3], 0.5);
  const SceneDescription board = read(
      "<bsdf type=\"diffuse\"><texture type=\"checkerboard\" name=\"reflectance\"><rgb name=\"color1\" value=\"1 0 "
      "0\"/></texture></bsdf>");
  EXPECT_EQ(std::get<CheckerboardDescription>(board.textures.at(0)).color0, Rgb(0.4f));
  EXPECT_EQ(std::get<CheckerboardDescription>(board.textures.at(0)).color1, Rgb(1, 0, 0));
}

TEST_F(TextureScenes, EveryColourOfAMaterialMayBeOne) {
  const auto one = [&](const std::string& type, const std::string& parameter) {
    return read("<bsdf type=\"" + type + "\">" + bitmap(parameter) + "</bsdf>").materials.at(0);
  };
  EXPECT_EQ(std::get<DielectricDescription>(one("dielectric", "specular_reflectance")).specular_reflectance_texture, 0);
  EXPECT_EQ(std::get<DielectricDescription>(one("dielectric", "specular_transmittance")).specular_transmittance_texture, 0);
  EXPECT_EQ(std::get<RoughDielectricDescription>(one("roughdielectric", "specular_transmittance"))
                .dielectric.specular_transmittance_texture,
            0);
  EXPECT_EQ(std::get<ConductorDescription>(one("conductor", "specular_reflectance")).specular_reflectance_texture, 0);
  EXPECT_EQ(
      std::get<RoughConductorDescription>(one("roughconductor", "specular_reflectance")).conductor.specular_reflectance_texture, 0);
  const auto rough = std::get<RoughConductorDescription>(one("roughconductor", "alpha"));
  EXPECT_EQ(rough.roughness.alpha_texture, 0);
  EXPECT_EQ(rough.roughness.alpha_u, 1);
  EXPECT_EQ(std::get<PlasticDescription>(one("plastic", "diffuse_reflectance")).diffuse_reflectance_texture, 0);
  EXPECT_EQ(std::get<PlasticDescription>(one("plastic", "specular_reflectance")).specular_reflectance_texture, 0);
  EXPECT_EQ(std::get<RoughPlasticDescription>(one("roughplastic", "diffuse_reflectance")).plastic.diffuse_reflectance_texture, 0);
}

TEST_F(TextureScenes, ReferencesShareATextureAndTexturesAnImage) {
  const std::string texture = "<texture type=\"bitmap\" id=\"t\"><string name=\"filename\" value=\"a.exr\"/></texture>";
  const SceneDescription scene =
      read("<bsdf type=\"plastic\"><ref id=\"t\" name=\"diffuse_reflectance\"/>" + bitmap("specular_reflectance") + "</bsdf>",
           texture + "<shape type=\"disk\"><bsdf type=\"diffuse\"><ref id=\"t\" name=\"reflectance\"/></bsdf></shape>");
  ASSERT_EQ(scene.textures.size(), 2u);
  const auto& plastic = std::get<PlasticDescription>(scene.materials.at(1));
  EXPECT_EQ(std::get<DiffuseDescription>(scene.materials.at(0)).reflectance_texture, plastic.diffuse_reflectance_texture);
  EXPECT_EQ(std::get<BitmapDescription>(scene.textures[0]).image, std::get<BitmapDescription>(scene.textures[1]).image);
}

TEST_F(TextureScenes, JsonSaysTheSame) {
  const SceneDescription scene = folder_.read_json(R"({"type": "scene", "camera": {"type": "perspective"},
    "board": {"type": "checkerboard", "color0": {"type": "rgb", "value": [1, 0, 0]}},
    "ball": {"type": "sphere", "paint": {"type": "plastic", "diffuse_reflectance": {"type": "ref", "id": "board"},
             "specular_reflectance": {"type": "bitmap", "filename": "a.exr", "to_uv": [{"type": "scale", "value": 2}]}}}})");
  ASSERT_EQ(scene.textures.size(), 2u);
  const auto& plastic = std::get<PlasticDescription>(scene.materials.at(0));
  EXPECT_EQ(plastic.diffuse_reflectance_texture, 0);
  EXPECT_EQ(plastic.specular_reflectance_texture, 1);
  EXPECT_EQ(std::get<CheckerboardDescription>(scene.textures[0]).color0, Rgb(1, 0, 0));
  EXPECT_EQ(std::get<BitmapDescription>(scene.textures[1]).to_uv.matrix()[1][1], 2);
}

TEST_F(TextureScenes, OldSpellingsAreRead) {
  const SceneDescription scene = folder_.read_whole_xml(
      "<scene version=\"0.6.0\"><sensor type=\"perspective\"/><emitter type=\"constant\"/><shape type=\"sphere\"><bsdf "
      "type=\"plastic\">"
      "<texture type=\"bitmap\" name=\"diffuseReflectance\"><string name=\"filename\" value=\"a.exr\"/><string name=\"filterType\" "
      "value=\"nearest\"/></texture></bsdf></shape></scene>");
  EXPECT_EQ(std::get<PlasticDescription>(scene.materials.at(0)).diffuse_reflectance_texture, 0);
  EXPECT_EQ(std::get<BitmapDescription>(scene.textures.at(0)).filter, TextureFilter::kNearest);
}

TEST_F(TextureScenes, MistakesAreNamed) {
  EXPECT_EQ(
      error("<bsdf type=\"diffuse\">\n" + bitmap("reflectence") + "</bsdf>"),
      "scene.xml:3: bsdf \"diffuse\" cannot hold a texture \"bitmap\" as \"reflectence\"; it takes textures named reflectance");
  EXPECT_EQ(error("<bsdf type=\"diffuse\"><texture type=\"bitmap\" name=\"reflectance\"/></bsdf>"),
            "scene.xml:2: texture \"bitmap\": lacks the parameter \"filename\"");
  EXPECT_EQ(error("<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"1\"/>" + bitmap("reflectance") + "</bsdf>"),
            "scene.xml:2: bsdf \"diffuse\" has the parameter \"reflectance\" twice");
  EXPECT_EQ(error("<bsdf type=\"diffuse\">" + bitmap("reflectance", "<float name=\"gamma\" value=\"1\"/>") + "</bsdf>"),
            "scene.xml:2: texture \"bitmap\" has no parameter \"gamma\"; it takes accel, filename, filter_type, format, raw, "
            "to_uv, wrap_mode");
  EXPECT_EQ(error("<bsdf type=\"diffuse\">" + bitmap("reflectance", "<string name=\"wrap_mode\" value=\"border\"/>") + "</bsdf>"),
            "scene.xml:2: texture \"bitmap\": wrap_mode = \"border\", expected repeat, mirror or clamp");
  EXPECT_EQ(error("<bsdf type=\"diffuse\">" + bitmap("reflectance", "<string name=\"filter_type\" value=\"ewa\"/>") + "</bsdf>"),
            "scene.xml:2: texture \"bitmap\": filter_type = \"ewa\", expected bilinear or nearest");
  EXPECT_EQ(error("<bsdf type=\"diffuse\"><ref id=\"g\" name=\"reflectance\"/></bsdf>", "<bsdf type=\"plastic\" id=\"g\"/>"),
            "scene.xml:2: the id \"g\" belongs to a bsdf \"plastic\" at scene.xml:2, expected a texture");
  EXPECT_EQ(error("<bsdf type=\"roughplastic\">" + bitmap("alpha") + "</bsdf>"),
            "scene.xml:2: bsdf \"roughplastic\" cannot hold a texture \"bitmap\" as \"alpha\"; it takes textures named "
            "diffuse_reflectance, "
            "specular_reflectance");
  EXPECT_EQ(error("<bsdf type=\"diffuse\"><texture type=\"bitmap\" name=\"reflectance\"><string name=\"filename\" "
                  "value=\"none.png\"/></texture></bsdf>"),
            "scene.xml:2: file \"none.png\" does not exist in the scene's folder");
  EXPECT_EQ(error("<bsdf type=\"diffuse\"><texture type=\"bitmap\" name=\"reflectance\"><string name=\"filename\" "
                  "value=\"bad.exr\"/></texture></bsdf>"),
            "bad.exr: is no image that can be read, expected EXR, HDR, PNG or JPEG");
}

// As Mitsuba 3.6.4 lists the vertices of its cube: four for each of -y, +y, +x, +z, -x, -z, all with the same square.
TEST_F(TextureScenes, TheCubeShowsTheWholeSquareOnEachSide) {
  constexpr Vec2f kSquare[4] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  constexpr Vec3f kNormals[6] = {{0, -1, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {-1, 0, 0}, {0, 0, -1}};
  constexpr Vec3f kCorners[6][4] = {
      {{1, -1, -1}, {1, -1, 1}, {-1, -1, 1}, {-1, -1, -1}}, {{1, 1, -1}, {-1, 1, -1}, {-1, 1, 1}, {1, 1, 1}},
      {{1, -1, -1}, {1, 1, -1}, {1, 1, 1}, {1, -1, 1}},     {{1, -1, 1}, {1, 1, 1}, {-1, 1, 1}, {-1, -1, 1}},
      {{-1, -1, 1}, {-1, 1, 1}, {-1, 1, -1}, {-1, -1, -1}}, {{1, 1, -1}, {1, -1, -1}, {-1, -1, -1}, {-1, 1, -1}}};
  const SceneDescription scene = folder_.read_xml("<shape type=\"cube\"/>");
  const MeshDescription& cube = only_mesh(scene);
  int found = 0;
  for (std::size_t v = 0; v < cube.positions.size(); ++v) {
    for (std::size_t i = 0; i < 24; ++i) {
      if (!(cube.positions[v] == kCorners[i / 4][i % 4] && cube.normals[v] == kNormals[i / 4])) continue;
      ++found;
      EXPECT_EQ(cube.uvs[v].x, kSquare[i % 4].x) << i;
      EXPECT_EQ(cube.uvs[v].y, kSquare[i % 4].y) << i;
    }
  }
  EXPECT_EQ(found, 24);
}

TEST_F(TextureScenes, SpheresKeepTheirAxes) {
  const SceneDescription scene = folder_.read_xml(
      "<shape type=\"sphere\"><transform name=\"to_world\"><scale value=\"3\"/><rotate y=\"1\" angle=\"90\"/></transform></shape>"
      "<shape type=\"sphere\"><transform name=\"to_world\"><scale x=\"-1\"/></transform></shape>");
  const Frame turned = std::get<SphereDescription>(scene.shapes[0].geometry).axes;
  EXPECT_NEAR(length(turned.s - Vec3f{0, 0, -1}), 0, 1e-6f);
  EXPECT_NEAR(length(turned.n - Vec3f{1, 0, 0}), 0, 1e-6f);
  EXPECT_EQ(std::get<SphereDescription>(scene.shapes[1].geometry).axes.s, (Vec3f{-1, 0, 0}));
}

TEST_F(TextureScenes, TexturesThatNothingUsesAreCheckedButTheirImagesStayClosed) {
  const std::string unused = "<texture type=\"bitmap\" id=\"t\"><string name=\"filename\" value=\"bad.exr\"/></texture>";
  EXPECT_TRUE(read("", unused).textures.empty());
  EXPECT_TRUE(read("", unused + "<bsdf type=\"diffuse\" id=\"d\"><ref id=\"t\" name=\"reflectance\"/></bsdf>").textures.empty());
  EXPECT_NE(error("", "<texture type=\"checkerboard\"><float name=\"color0\" value=\"2\"/></texture>").find("color0 = 2"),
            std::string::npos);
}

}  // namespace
}  // namespace fluxfarm
