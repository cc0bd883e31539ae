// Media and phase functions in scene files.
#include "io/scene_folder.h"

namespace fluxfarm {
namespace {

// A sphere with `inside` on the lines from 3 on.
std::string ball(const std::string& inside) { return "<shape type=\"sphere\"><bsdf type=\"null\"/>\n" + inside + "</shape>"; }
std::string filled(const std::string& medium) {
  return ball("<medium type=\"homogeneous\" name=\"interior\">\n" + medium + "</medium>");
}

TEST(Media, DefaultsAreMitsubas) {
  const SceneFolder folder;
  const SceneDescription scene = folder.read_xml(filled(""));
  ASSERT_EQ(scene.media.size(), 1u);
  EXPECT_EQ(scene.media[0].sigma_t, Rgb(1.0f));
  EXPECT_EQ(scene.media[0].albedo, Rgb(0.75f));
  EXPECT_EQ(scene.media[0].asymmetry, 0);
  EXPECT_EQ(scene.shapes[0].interior_medium, 0);
  EXPECT_EQ(scene.shapes[0].exterior_medium, kNoMedium);
  EXPECT_EQ(scene.camera.medium, kNoMedium);
  EXPECT_EQ(folder.read_xml(filled("<phase type=\"hg\"/>")).media[0].asymmetry, 0.8f);
  EXPECT_EQ(folder.read_xml(filled("<phase type=\"isotropic\"/>")).media[0].asymmetry, 0);
}

TEST(Media, ExtinctionIsScaled) {
  const SceneFolder folder;
  const auto medium = [&](const std::string& text) { return folder.read_xml(filled(text)).media.at(0); };
  EXPECT_EQ(medium("<rgb name=\"sigma_t\" value=\"1 2 4\"/><float name=\"scale\" value=\"3\"/>").sigma_t, Rgb(3, 6, 12));
  const HomogeneousMediumDescription by_parts =
      medium("<rgb name=\"sigma_a\" value=\"1 0 0\"/><rgb name=\"sigma_s\" value=\"3 2 0\"/><float name=\"scale\" value=\"2\"/>");
  EXPECT_EQ(by_parts.sigma_t, Rgb(8, 4, 0));
  EXPECT_EQ(by_parts.albedo, Rgb(0.75f, 1, 0));
}

TEST(Media, OneMediumMayFillManyShapesAndHoldTheCamera) {
  const SceneFolder folder;
  const SceneDescription scene = folder.read_whole_xml(R"(<scene version="0.6.0">
    <medium type="homogeneous" id="fog"><float name="sigmaT" value="2"/><ref id="peak"/></medium>
    <phase type="hg" id="peak"><float name="g" value="-0.5"/></phase>
    <sensor type="perspective"><ref id="fog"/></sensor>
    <shape type="sphere"><ref name="exterior" id="fog"/></shape>
    <shape type="sphere"><ref name="exterior" id="fog"/><medium type="homogeneous" name="interior"/></shape></scene>)");
  ASSERT_EQ(scene.media.size(), 2u);
  const int fog = scene.shapes.at(0).exterior_medium;
  EXPECT_EQ(scene.camera.medium, fog);
  EXPECT_EQ(scene.shapes.at(1).exterior_medium, fog);
  EXPECT_EQ(scene.shapes.at(1).interior_medium, 1 - fog);
  EXPECT_EQ(scene.media.at(static_cast<std::size_t>(fog)).asymmetry, -0.5f);
  EXPECT_EQ(scene.media.at(static_cast<std::size_t>(fog)).sigma_t, Rgb(2.0f));
}

TEST(Media, JsonHoldsThemByName) {
  const SceneFolder folder;
  const SceneDescription scene = folder.read_json(R"({"type": "scene", "camera": {"type": "perspective"},
    "milk": {"type": "homogeneous", "albedo": {"type": "rgb", "value": [1, 0.5, 0]}, "phase": {"type": "hg", "g": 0.25}},
    "glass": {"type": "sphere", "bsdf": {"type": "null"}, "interior": {"type": "ref", "id": "milk"}}})");
  ASSERT_EQ(scene.media.size(), 1u);
  EXPECT_EQ(scene.media[0].albedo, Rgb(1, 0.5f, 0));
  EXPECT_EQ(scene.media[0].asymmetry, 0.25f);
  EXPECT_EQ(scene.shapes.at(0).interior_medium, 0);
}

TEST(Media, IntegratorsForVolumesAreThePathTracer) {
  const SceneFolder folder;
  for (const char* name : {"volpath", "volpathmis", "path"}) {
    const SceneDescription scene =
        folder.read_xml("<integrator type=\"" + std::string(name) + "\"><integer name=\"max_depth\" value=\"7\"/></integrator>");
    EXPECT_EQ(scene.method.integrator, "path");
    EXPECT_EQ(scene.method.max_depth, 7);
  }
}

TEST(BadMedia, CoefficientsAreChecked) {
  const SceneFolder folder;
  const auto error = [&](const std::string& medium) { return error_of([&] { folder.read_xml(filled(medium)); }); };
  const std::string where = "scene.xml:4: medium \"homogeneous\": ";
  EXPECT_EQ(error("<float name=\"sigma_t\" value=\"-1\"/>"), where + "sigma_t = -1, expected numbers of at least 0");
  EXPECT_EQ(error("<rgb name=\"albedo\" value=\"0.5 1.5 0\"/>"), where + "albedo = 0.5, 1.5, 0, expected numbers in [0, 1]");
  EXPECT_EQ(error("<float name=\"scale\" value=\"-2\"/>"), where + "scale = -2, expected a number of at least 0");
  EXPECT_EQ(error("<float name=\"sigma_t\" value=\"1e30\"/><float name=\"scale\" value=\"1e30\"/>"),
            where + "scale = 1e+30, with it the extinction becomes infinite");
  EXPECT_EQ(error("<rgb name=\"sigma_t\" value=\"0 1 1e-20\"/>"),
            where + "sigma_t = 0, 1, 1e-20, with scale an extinction of 1e-20, expected 0 or at least 1e-12");
  EXPECT_EQ(folder.read_xml(filled("<float name=\"sigma_t\" value=\"1e-20\"/><float name=\"albedo\" value=\"0\"/>")).media.size(),
            1u)
      << "nothing scatters there";
  EXPECT_EQ(error("<float name=\"sigma_a\" value=\"1\"/>"), where + "sigma_a = 1, but sigma_a and sigma_s must be given together");
  EXPECT_EQ(error("<float name=\"sigma_a\" value=\"1\"/><float name=\"sigma_s\" value=\"1\"/><float name=\"albedo\" value=\"1\"/>"),
            where + "sigma_a = 1, but sigma_t or albedo are given, too; expected sigma_t and albedo, or sigma_a and sigma_s");
  EXPECT_EQ(error("<float name=\"density\" value=\"1\"/>").find("scene.xml:4: medium \"homogeneous\" has no parameter \"density\""),
            0u);
}

TEST(BadMedia, PhaseFunctionsAreChecked) {
  const SceneFolder folder;
  const auto error = [&](const std::string& phase) { return error_of([&] { folder.read_xml(filled(phase)); }); };
  for (const char* g : {"1", "-1", "1.5"}) {
    EXPECT_EQ(error("<phase type=\"hg\"><float name=\"g\" value=\"" + std::string(g) + "\"/></phase>"),
              "scene.xml:4: phase \"hg\": g = " + std::string(g) + ", expected a number in (-1, 1)");
  }
  EXPECT_EQ(error("<phase type=\"hg\"><float name=\"g\" value=\"0.9999999999\"/></phase>").find("scene.xml:4: phase \"hg\": g = "),
            0u);
  EXPECT_EQ(error("<phase type=\"rayleigh\"/>"), "scene.xml:4: unknown plugin: phase \"rayleigh\", expected one of: isotropic, hg");
  EXPECT_EQ(error("<phase type=\"hg\"/><phase type=\"isotropic\"/>"),
            "scene.xml:4: medium \"homogeneous\" cannot hold a phase \"isotropic\"; it takes one phase function");
  EXPECT_EQ(error("<phase type=\"isotropic\"><float name=\"g\" value=\"0\"/></phase>"),
            "scene.xml:4: phase \"isotropic\" has no parameter \"g\"; it takes none");
  EXPECT_EQ(error_of([&] { folder.read_xml("<phase type=\"hg\"><float name=\"g\" value=\"2\"/></phase>"); }),
            "scene.xml:2: phase \"hg\": g = 2, expected a number in (-1, 1)");
}

TEST(BadMedia, StandWhereTheyFillSomething) {
  const SceneFolder folder;
  EXPECT_EQ(error_of([&] { folder.read_xml("<medium type=\"heterogeneous\" id=\"a\"/>"); }),
            "scene.xml:2: unknown plugin: medium \"heterogeneous\", expected one of: homogeneous");
  EXPECT_EQ(error_of([&] { folder.read_xml("<medium type=\"homogeneous\" id=\"a\"/>"); }),
            "scene.xml:2: medium \"homogeneous\" fills nothing, expected a shape or the sensor that refers to it");
  EXPECT_EQ(
      error_of([&] { folder.read_xml("<medium type=\"homogeneous\"/>"); }),
      "scene.xml:2: medium \"homogeneous\" fills nothing, expected a shape or the sensor that refers to it; it needs an id for "
      "that");
  EXPECT_EQ(
      error_of([&] { folder.read_xml(ball("<medium type=\"homogeneous\" name=\"inside\"/>")); }),
      "scene.xml:3: shape \"sphere\" holds a medium \"homogeneous\" named \"inside\", expected the name interior or exterior");
  EXPECT_EQ(
      error_of([&] {
        folder.read_xml(ball("<medium type=\"homogeneous\" name=\"interior\"/>\n<medium type=\"homogeneous\" name=\"interior\"/>"));
      }),
      "scene.xml:4: shape \"sphere\" has a second medium named \"interior\"");
  EXPECT_EQ(error_of([&] { folder.read_xml(ball("<ref name=\"interior\" id=\"b\"/>") + "<bsdf type=\"diffuse\" id=\"b\"/>"); }),
            "scene.xml:3: the id \"b\" belongs to a bsdf \"diffuse\" at scene.xml:3, expected a medium");
  EXPECT_EQ(error_of([&] { folder.read_xml("<bsdf type=\"twosided\"><bsdf type=\"null\"/></bsdf>"); }),
            "scene.xml:2: bsdf \"twosided\" holds a material that transmits light, expected an opaque one");
}

}  // namespace
}  // namespace fluxfarm
