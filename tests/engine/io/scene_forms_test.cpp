// The XML and the JSON form, <default>, $name, <include>, references and the 0.6 spellings.
#include "io/describe.h"
#include "io/scene_folder.h"

namespace fluxfarm {
namespace {

constexpr const char* kObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

constexpr const char* kXml = R"(<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="7"/><boolean name="hide_emitters" value="true"/></integrator>
  <sensor type="perspective">
    <float name="fov" value="35"/><string name="fov_axis" value="smaller"/>
    <transform name="to_world"><lookat origin="1, 2, 3" target="0, 0, 0" up="0, 1, 0"/></transform>
    <sampler type="independent"><integer name="sample_count" value="16"/></sampler>
    <film type="hdrfilm"><integer name="width" value="320"/><integer name="height" value="200"/>
      <integer name="crop_offset_x" value="10"/><integer name="crop_width" value="100"/><rfilter type="tent"/></film>
  </sensor>
  <bsdf type="twosided" id="metal"><bsdf type="roughconductor">
    <float name="alpha" value="0.2"/><string name="material" value="Au"/><string name="distribution" value="ggx"/></bsdf></bsdf>
  <shape type="obj" id="triangle"><string name="filename" value="models/a mesh.obj"/>
    <transform name="to_world"><scale value="2"/><rotate x="0" y="1" z="0" angle="90"/><translate x="1" y="2" z="3"/></transform>
    <ref id="metal"/></shape>
  <shape type="sphere" id="ball"><point name="center" x="1" y="2" z="3"/><float name="radius" value="0.5"/>
    <bsdf type="dielectric"><string name="int_ior" value="water"/></bsdf></shape>
  <shape type="rectangle" id="lamp"><emitter type="area"><rgb name="radiance" value="1, 2, 3"/></emitter></shape>
  <emitter type="point" id="bulb"><point name="position" x="0" y="5" z="0"/><spectrum name="intensity" value="4"/></emitter>
  <emitter type="spot" id="stage"><transform name="to_world"><lookat origin="0 4 0" target="1 0 0" up="0 0 1"/></transform>
    <rgb name="intensity" value="3, 2, 1"/><float name="cutoff_angle" value="30"/><float name="beam_width" value="10"/></emitter>
  <emitter type="directional" id="sun"><vector name="direction" value="1 -2 0"/><float name="irradiance" value="5"/></emitter>
</scene>)";

constexpr const char* kJson = R"({"type": "scene",
  "integrator": {"type": "path", "max_depth": 7, "hide_emitters": true},
  "sensor": {"type": "perspective", "fov": 35, "fov_axis": "smaller",
    "to_world": [{"type": "lookat", "origin": [1, 2, 3], "target": [0, 0, 0], "up": [0, 1, 0]}],
    "sampler": {"type": "independent", "sample_count": 16},
    "film": {"type": "hdrfilm", "width": 320, "height": 200, "crop_offset_x": 10, "crop_width": 100, "filter": {"type": "tent"}}},
  "metal": {"type": "twosided", "nested": {"type": "roughconductor", "alpha": 0.2, "material": "Au", "distribution": "ggx"}},
  "triangle": {"type": "obj", "filename": "models/a mesh.obj", "bsdf": {"type": "ref", "id": "metal"},
    "to_world": [{"type": "scale", "value": 2}, {"type": "rotate", "axis": [0, 1, 0], "angle": 90}, {"type": "translate", "value": [1, 2, 3]}]},
  "ball": {"type": "sphere", "center": [1, 2, 3], "radius": 0.5, "bsdf": {"type": "dielectric", "int_ior": "water"}},
  "lamp": {"type": "rectangle", "emitter": {"type": "area", "radiance": {"type": "rgb", "value": [1, 2, 3]}},
    "to_world": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]},
  "bulb": {"type": "point", "position": [0, 5, 0], "intensity": {"type": "spectrum", "value": 4}},
  "stage": {"type": "spot", "intensity": {"type": "rgb", "value": [3, 2, 1]}, "cutoff_angle": 30, "beam_width": 10,
    "to_world": [{"type": "lookat", "origin": [0, 4, 0], "target": [1, 0, 0], "up": [0, 0, 1]}]},
  "sun": {"type": "directional", "direction": [1, -2, 0], "irradiance": 5}})";

TEST(SceneForms, XmlAndJsonOfOneSceneGiveTheSameDescription) {
  const SceneFolder folder;
  folder.write("models/a mesh.obj", kObj);
  const std::string from_xml = describe(folder.read_whole_xml(kXml));
  EXPECT_EQ(from_xml, describe(folder.read_json(kJson)));
  EXPECT_NE(from_xml.find("fov 3 35 clip 0.01 10000 lens 0 1\nfilm 320 200 crop 10 0 100 200 filter 1 1"), std::string::npos)
      << from_xml;
}

TEST(SceneForms, StepsOfATransformApplyInTheOrderOfTheFile) {
  const SceneFolder folder;
  folder.write("models/a mesh.obj", kObj);
  const SceneDescription scene = folder.read_whole_xml(kXml);
  // (1, 0, 0) is scaled to (2, 0, 0), turned about y to (0, 0, -2) and moved.
  const Vec3f p = std::get<MeshDescription>(scene.shapes[0].geometry).positions[1];
  EXPECT_NEAR(p.x, 1, 1e-6f);
  EXPECT_NEAR(p.y, 2, 1e-6f);
  EXPECT_NEAR(p.z, 1, 1e-6f);
}

TEST(SceneForms, DefaultsAreMitsubas) {
  const SceneFolder folder;
  const SceneDescription scene = folder.read_whole_xml("<scene version=\"3.0.0\"><sensor type=\"perspective\"/></scene>");
  EXPECT_EQ(scene.film.width, 768);
  EXPECT_EQ(scene.film.height, 576);
  EXPECT_EQ(scene.film.filter.kind, PixelFilterKind::kGaussian);
  EXPECT_FLOAT_EQ(scene.film.filter.radius, 2);
  EXPECT_EQ(scene.camera.fov_axis, CameraDescription::FovAxis::kDiagonal);
  // 50 mm gives 38.18484 degrees in x at 768 x 576 in Mitsuba 3.6.
  const double tangent = std::tan(static_cast<double>(scene.camera.fov_degrees) * M_PI / 360) * 768 / std::hypot(768, 576);
  EXPECT_NEAR(std::atan(tangent) * 360 / M_PI, 38.18484, 1e-4);
  EXPECT_EQ(scene.method.max_depth, -1);
  EXPECT_EQ(scene.method.rr_depth, 5);
  EXPECT_EQ(scene.samples_per_pixel, 0);
}

TEST(SceneForms, DefaultGivesWayToOverride) {
  const SceneFolder folder;
  const std::string body = "<default name=\"r\" value=\"2\"/><shape type=\"sphere\"><float name=\"radius\" value=\"$r\"/></shape>";
  EXPECT_FLOAT_EQ(std::get<SphereDescription>(folder.read_xml(body).shapes[0].geometry).radius, 2);
  EXPECT_FLOAT_EQ(std::get<SphereDescription>(folder.read_xml(body, {{"r", "3"}}).shapes[0].geometry).radius, 3);
}

TEST(SceneForms, OverrideThatTheSceneDoesNotUseIsAnError) {
  const SceneFolder folder;
  const std::string body = "<default name=\"size\" value=\"2\"/>";
  EXPECT_EQ(error_of([&] {
              folder.read_xml(body, {{"sise", "3"}});
            }),
            "scene.xml: the scene does not use $sise, which was given from outside; it has $size");
}

TEST(SceneForms, UnsetNameIsAnErrorWithItsPlace) {
  const SceneFolder folder;
  EXPECT_EQ(error_of([&] { folder.read_xml("\n<shape type=\"sphere\"><float name=\"radius\" value=\"$r\"/></shape>"); }),
            "scene.xml:3: $r has no value; put <default name=\"r\" value=\"...\"/> before it or give it from outside");
}

TEST(SceneForms, IncludedFilesAreReadWithTheirOwnPlaces) {
  const SceneFolder folder;
  folder.write("parts/shapes.xml", "<scene version=\"3.0.0\">\n<shape type=\"sphere\" id=\"s\"><ref id=\"late\"/></shape></scene>");
  folder.write("parts/material.xml",
               "<bsdf version=\"3.0.0\" type=\"diffuse\" id=\"late\">\n<rgb name=\"reflectence\" value=\"1\"/></bsdf>");
  const std::string body = "<include filename=\"parts/shapes.xml\"/><include filename=\"parts/material.xml\"/>";
  EXPECT_EQ(error_of([&] { folder.read_xml(body); }),
            "parts/material.xml:2: bsdf \"diffuse\" has no parameter \"reflectence\"; it takes reflectance");
  folder.write("parts/material.xml", "<bsdf version=\"3.0.0\" type=\"diffuse\" id=\"late\"/>");
  EXPECT_EQ(folder.read_xml(body).shapes[0].name, "s");
}

TEST(SceneForms, IncludeThatIncludesItselfIsAnError) {
  const SceneFolder folder;
  folder.write("again.xml", "<scene version=\"3.0.0\"><include filename=\"scene.xml\"/></scene>");
  EXPECT_EQ(error_of([&] { folder.read_xml("<include filename=\"again.xml\"/>"); }),
            "again.xml:1: <include> filename = \"scene.xml\" includes itself, directly or through other files");
}

TEST(SceneForms, OldSpellingsAreReadInFilesOfOldVersion) {
  const SceneFolder folder;
  const std::string text = R"(<scene version="0.6.0"><integrator type="path"><integer name="maxDepth" value="4"/></integrator>
    <sensor type="perspective"><float name="nearClip" value="0.5"/><string name="focalLength" value="50mm"/>
      <transform name="toWorld"><lookAt origin="0 0 1" target="0 0 0" up="0 1 0"/></transform>
      <film type="hdrfilm"><string name="pixelFormat" value="rgb"/><boolean name="banner" value="false"/></film></sensor>
    <shape type="sphere"><bsdf type="dielectric"><float name="intIOR" value="1.8"/><float name="extIOR" value="1"/></bsdf></shape></scene>)";
  const SceneDescription scene = folder.read_whole_xml(text);
  EXPECT_EQ(scene.method.max_depth, 4);
  EXPECT_FLOAT_EQ(scene.camera.near_clip, 0.5f);
  EXPECT_FLOAT_EQ(std::get<DielectricDescription>(scene.materials[0]).eta, 1.8f);
  EXPECT_EQ(error_of([&] { folder.read_xml("<shape type=\"sphere\"><boolean name=\"flipNormals\" value=\"true\"/></shape>"); }),
            "scene.xml:2: shape \"sphere\" has no parameter \"flipNormals\"; it takes center, flip_normals, radius, to_world");
}

TEST(SceneForms, ReferencesMayStandBeforeWhatTheyReferTo) {
  const SceneFolder folder;
  const SceneDescription scene = folder.read_xml(
      "<shape type=\"sphere\"><ref id=\"m\"/></shape><shape type=\"sphere\"><ref id=\"m\"/></shape>\n"
      "<bsdf type=\"diffuse\" id=\"m\"/>");
  EXPECT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.shapes[0].material, scene.shapes[1].material);
}

TEST(SceneForms, WrongReferencesAreErrors) {
  const SceneFolder folder;
  EXPECT_EQ(error_of([&] { folder.read_xml("<shape type=\"sphere\"><ref id=\"m\"/></shape>"); }),
            "scene.xml:2: nothing in the scene has the id \"m\"");
  EXPECT_EQ(error_of([&] { folder.read_xml("<shape type=\"sphere\" id=\"m\">\n<ref id=\"m\"/></shape>"); }),
            "scene.xml:3: the id \"m\" belongs to a shape \"sphere\" at scene.xml:2, expected a bsdf");
  EXPECT_EQ(error_of([&] { folder.read_xml("<bsdf type=\"diffuse\" id=\"m\"/>\n<bsdf type=\"diffuse\" id=\"m\"/>"); }),
            "scene.xml:3: the id \"m\" is already used at scene.xml:2");
  EXPECT_EQ(error_of([&] { folder.read_xml("<bsdf type=\"twosided\" id=\"m\"><ref id=\"m\"/></bsdf>"); }),
            "scene.xml:2: bsdf \"twosided\" contains itself");
}

}  // namespace
}  // namespace fluxfarm
