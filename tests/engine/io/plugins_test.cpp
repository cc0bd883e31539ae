// Parameters of materials, shapes and emitters: defaults and meanings as in Mitsuba 3.6.
#include "io/describe.h"
#include "io/scene_folder.h"

namespace fluxfarm {
namespace {

// The material of a sphere with that bsdf inside.
MaterialDescription material(const SceneFolder& folder, const std::string& bsdf) {
  const SceneDescription scene = folder.read_xml("<shape type=\"sphere\">" + bsdf + "</shape>");
  return scene.materials.at(static_cast<std::size_t>(scene.shapes.at(0).material));
}

std::string material_error(const SceneFolder& folder, const std::string& bsdf) {
  return error_of([&] { material(folder, bsdf); });
}

TEST(Materials, DefaultsAreMitsubas) {
  const SceneFolder folder;
  EXPECT_EQ(std::get<DiffuseDescription>(material(folder, "<bsdf type=\"diffuse\"/>")).reflectance, Rgb(0.5f));
  EXPECT_NEAR(std::get<DielectricDescription>(material(folder, "<bsdf type=\"dielectric\"/>")).eta, 1.5041833f, 1e-6f);
  EXPECT_NEAR(std::get<PlasticDescription>(material(folder, "<bsdf type=\"plastic\"/>")).eta, 1.4895873f, 1e-6f);
  EXPECT_TRUE(std::get<ConductorDescription>(material(folder, "<bsdf type=\"conductor\"/>")).perfect);
  const auto rough = std::get<RoughConductorDescription>(material(folder, "<bsdf type=\"roughconductor\"/>"));
  EXPECT_EQ(rough.roughness.distribution, MicrofacetDistribution::kBeckmann);
  EXPECT_FLOAT_EQ(rough.roughness.alpha_u, 0.1f);
  EXPECT_FLOAT_EQ(std::get<RoughPlasticDescription>(material(folder, "<bsdf type=\"roughplastic\"/>")).roughness.alpha_v, 0.1f);
}

TEST(Materials, IndicesMayBeNumbersOrNames) {
  const SceneFolder folder;
  const std::string bsdf =
      "<bsdf type=\"dielectric\"><string name=\"int_ior\" value=\"Diamond\"/><float name=\"ext_ior\" value=\"2\"/></bsdf>";
  EXPECT_FLOAT_EQ(std::get<DielectricDescription>(material(folder, bsdf)).eta, 2.419f / 2);
  EXPECT_EQ(
      material_error(folder, "<bsdf type=\"dielectric\"><string name=\"int_ior\" value=\"jelly\"/></bsdf>")
          .find("scene.xml:2: bsdf \"dielectric\": int_ior = \"jelly\", expected a number greater than 0 or one of: vacuum, "),
      0u);
}

TEST(Materials, ConductorsTakeAMaterialOrAnIndex) {
  const SceneFolder folder;
  const auto gold =
      std::get<ConductorDescription>(material(folder, "<bsdf type=\"conductor\"><string name=\"material\" value=\"Au\"/></bsdf>"));
  EXPECT_FALSE(gold.perfect);
  EXPECT_NEAR(gold.eta.r, 0.143036f, 1e-6f);
  EXPECT_NEAR(gold.k.b, 1.60336f, 1e-5f);
  const auto copper = std::get<ConductorDescription>(material(
      folder,
      "<bsdf type=\"conductor\"><rgb name=\"eta\" value=\"0.2 0.9 1.1\"/><rgb name=\"k\" value=\"3.9, 2.4, 2.1\"/></bsdf>"));
  EXPECT_EQ(copper.eta, Rgb(0.2f, 0.9f, 1.1f));
  EXPECT_EQ(copper.k, Rgb(3.9f, 2.4f, 2.1f));
  EXPECT_EQ(material_error(
                folder, "<bsdf type=\"conductor\"><string name=\"material\" value=\"Au\"/><float name=\"k\" value=\"1\"/></bsdf>"),
            "scene.xml:2: bsdf \"conductor\": material = \"Au\", but eta or k are given, too; expected one or the other");
}

TEST(Materials, RoughnessIsCheckedAndKeptAboveZero) {
  const SceneFolder folder;
  const auto alpha = [](const std::string& value) {
    return "<bsdf type=\"roughconductor\"><float name=\"alpha\" value=\"" + value + "\"/></bsdf>";
  };
  EXPECT_EQ(material_error(folder, alpha("1.7")), "scene.xml:2: bsdf \"roughconductor\": alpha = 1.7, expected a number in [0, 1]");
  EXPECT_FLOAT_EQ(std::get<RoughConductorDescription>(material(folder, alpha("0"))).roughness.alpha_u, 1e-4f);
  EXPECT_EQ(material_error(folder, "<bsdf type=\"roughplastic\"><string name=\"distribution\" value=\"phong\"/></bsdf>"),
            "scene.xml:2: bsdf \"roughplastic\": distribution = \"phong\", expected beckmann or ggx");
}

TEST(Materials, ReflectancesLieBetweenZeroAndOne) {
  const SceneFolder folder;
  EXPECT_EQ(material_error(folder, "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.5, 1.2, 0\"/></bsdf>"),
            "scene.xml:2: bsdf \"diffuse\": reflectance = 0.5, 1.2, 0, expected numbers in [0, 1]");
  EXPECT_EQ(material_error(folder, "<bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"400:0.5, 700:0.7\"/></bsdf>"),
            "scene.xml:2: <spectrum> value = \"400:0.5, 700:0.7\": spectra by wavelength are not supported, expected one "
            "number, or use <rgb>");
  EXPECT_EQ(material_error(folder, "<bsdf type=\"diffuse\">\n<texture type=\"marble\" name=\"reflectance\"/></bsdf>"),
            "scene.xml:3: unknown plugin: texture \"marble\", expected one of: bitmap, checkerboard, mesh_attribute");
}

TEST(Materials, TwosidedTakesOneOrTwoOpaqueMaterials) {
  const SceneFolder folder;
  const std::string diffuse = "<bsdf type=\"diffuse\"/>", glass = "<bsdf type=\"dielectric\"/>";
  const auto twosided = [](const std::string& inside) { return "<bsdf type=\"twosided\">" + inside + "</bsdf>"; };
  const auto one = std::get<TwosidedDescription>(material(folder, twosided(diffuse)));
  EXPECT_EQ(one.front, one.back);
  const auto two = std::get<TwosidedDescription>(material(folder, twosided(diffuse + "<bsdf type=\"plastic\"/>")));
  EXPECT_EQ(two.front, 0);
  EXPECT_EQ(two.back, 1);
  const auto nested = std::get<TwosidedDescription>(material(folder, twosided(twosided(diffuse))));
  EXPECT_EQ(nested.front, 0);
  EXPECT_EQ(material_error(folder, twosided("")), "scene.xml:2: bsdf \"twosided\" holds 0 bsdfs, expected one or two");
  EXPECT_EQ(material_error(folder, twosided(glass)),
            "scene.xml:2: bsdf \"twosided\" holds a material that transmits light, expected an opaque one");
}

TEST(Materials, ThatNoShapeUsesAreCheckedButLeftOut) {
  const SceneFolder folder;
  EXPECT_TRUE(folder.read_xml("<bsdf type=\"dielectric\" id=\"unused\"/>").materials.empty());
  EXPECT_NE(error_of([&] {
              folder.read_xml("<bsdf type=\"dielectric\" id=\"unused\"><float name=\"int_ior\" value=\"-1\"/></bsdf>");
            }).find("int_ior = -1, expected a number greater than 0"),
            std::string::npos);
}

TEST(Shapes, WithoutABsdfAreGreyAndLightsBlack) {
  const SceneFolder folder;
  EXPECT_EQ(std::get<DiffuseDescription>(material(folder, "")).reflectance, Rgb(0.5f));
  EXPECT_EQ(std::get<DiffuseDescription>(material(folder, "<emitter type=\"area\"/>")).reflectance, Rgb(0.0f));
}

TEST(Shapes, SpheresTakeUniformScaleAndTurnInsideOutWhenMirrored) {
  const SceneFolder folder;
  const SceneDescription scene = folder.read_xml(
      "<shape type=\"sphere\"><point name=\"center\" value=\"1 0 0\"/><float name=\"radius\" value=\"3\"/>"
      "<transform name=\"to_world\"><scale value=\"2\"/></transform></shape>"
      "<shape type=\"sphere\"><transform name=\"to_world\"><scale x=\"-1\"/></transform></shape>");
  EXPECT_EQ(std::get<SphereDescription>(scene.shapes[0].geometry).center, (Vec3f{2, 0, 0}));
  EXPECT_FLOAT_EQ(std::get<SphereDescription>(scene.shapes[0].geometry).radius, 6);
  EXPECT_FALSE(scene.shapes[0].flip_normals);
  EXPECT_TRUE(scene.shapes[1].flip_normals);
}

TEST(Shapes, DisksStayRoundAndRectanglesKeepAnArea) {
  const SceneFolder folder;
  const auto error = [&](const std::string& type, const std::string& step) {
    return error_of(
        [&] { folder.read_xml("<shape type=\"" + type + "\"><transform name=\"to_world\">" + step + "</transform></shape>"); });
  };
  EXPECT_NE(error("disk", "<scale x=\"2\"/>").find("makes the disk an ellipse or a point"), std::string::npos);
  EXPECT_NE(error("rectangle", "<scale x=\"0\"/>").find("gives the rectangle no area"), std::string::npos);
  EXPECT_EQ(
      folder.read_xml("<shape type=\"rectangle\"><transform name=\"to_world\"><scale z=\"0\"/></transform></shape>").shapes.size(),
      1u);
}

TEST(Emitters, UniformSpectraHaveTheColourOfEqualEnergyWhite) {
  const SceneFolder folder;
  const auto intensity = [&](const std::string& value) {
    const SceneDescription scene = folder.read_xml("<emitter type=\"point\">" + value + "</emitter>");
    return std::get<PointEmitterDescription>(scene.emitters.at(1)).intensity;
  };
  EXPECT_EQ(intensity("<rgb name=\"intensity\" value=\"5\"/>"), Rgb(5));
  EXPECT_EQ(intensity("<float name=\"intensity\" value=\"5\"/>"), Rgb(5));
  const Rgb white = intensity("<spectrum name=\"intensity\" value=\"5\"/>");  // Mitsuba 3.6.4: 6.02397, 4.74146, 4.54458
  EXPECT_NEAR(white.r, 6.02397f, 1e-5f);
  EXPECT_NEAR(white.g, 4.74146f, 1e-5f);
  EXPECT_NEAR(white.b, 4.54458f, 1e-5f);
}

// The only emitter of a scene beside the one around it.
template <typename Description>
Description emitter(const SceneFolder& folder, const std::string& type, const std::string& inside) {
  const SceneDescription scene = folder.read_xml("<emitter type=\"" + type + "\">" + inside + "</emitter>");
  return std::get<Description>(scene.emitters.at(1));
}

TEST(Emitters, SpotsShineAlongTheirZAxis) {
  const SceneFolder folder;
  const auto bare = emitter<SpotEmitterDescription>(folder, "spot", "");
  EXPECT_EQ(bare.axis, (Vec3f{0, 0, 1}));
  EXPECT_EQ(bare.intensity, Rgb(1));
  EXPECT_FLOAT_EQ(bare.cutoff_angle_degrees, 20);
  EXPECT_FLOAT_EQ(bare.beam_width_degrees, 15);
  const auto turned =
      emitter<SpotEmitterDescription>(folder, "spot",
                                      "<float name=\"cutoff_angle\" value=\"40\"/><transform name=\"to_world\"><scale value=\"3\"/>"
                                      "<lookat origin=\"1 2 3\" target=\"1 0 3\" up=\"1 0 0\"/></transform>");
  EXPECT_EQ(turned.position, (Vec3f{1, 2, 3}));
  EXPECT_NEAR(turned.axis.y, -1, 1e-6f);
  EXPECT_FLOAT_EQ(turned.beam_width_degrees, 30);
}

TEST(Emitters, SpotsWithImpossibleConesAreErrors) {
  const SceneFolder folder;
  const auto error = [&](const std::string& inside) {
    return error_of([&] { emitter<SpotEmitterDescription>(folder, "spot", inside); });
  };
  EXPECT_EQ(error("<float name=\"cutoff_angle\" value=\"0\"/>"),
            "scene.xml:2: emitter \"spot\": cutoff_angle = 0, expected a number in (0, 180)");
  EXPECT_EQ(error("<float name=\"beam_width\" value=\"25\"/>"),
            "scene.xml:2: emitter \"spot\": beam_width = 25, expected a number in [0, 20]");
  EXPECT_EQ(error("<transform name=\"to_world\"><scale x=\"2\"/></transform>"),
            "scene.xml:2: emitter \"spot\": to_world = a transform, stretches or shears the light, expected the same scale, "
            "not 0, on all axes");
}

TEST(Emitters, DirectionalLightTravelsAlongItsDirection) {
  const SceneFolder folder;
  EXPECT_EQ(emitter<DirectionalEmitterDescription>(folder, "directional", "").direction, (Vec3f{0, 0, 1}));
  const auto given = emitter<DirectionalEmitterDescription>(
      folder, "directional", "<vector name=\"direction\" value=\"0 -3 4\"/><rgb name=\"irradiance\" value=\"1 2 3\"/>");
  EXPECT_NEAR(length(given.direction - Vec3f{0, -0.6f, 0.8f}), 0, 1e-6f);
  EXPECT_EQ(given.irradiance, Rgb(1, 2, 3));
  const auto turned = emitter<DirectionalEmitterDescription>(
      folder, "directional", "<transform name=\"to_world\"><rotate x=\"1\" angle=\"90\"/><translate x=\"9\"/></transform>");
  EXPECT_NEAR(length(turned.direction - Vec3f{0, -1, 0}), 0, 1e-6f);
}

TEST(Emitters, DirectionalLightNeedsOneDirection) {
  const SceneFolder folder;
  const std::string up = "<vector name=\"direction\" value=\"0 1 0\"/>", down = "<vector name=\"direction\" value=\"0 0 0\"/>";
  const std::string frame = "<transform name=\"to_world\"><rotate x=\"1\" angle=\"90\"/></transform>";
  const auto error = [&](const std::string& inside) {
    return error_of([&] { emitter<DirectionalEmitterDescription>(folder, "directional", inside); });
  };
  EXPECT_EQ(error(down), "scene.xml:2: emitter \"directional\": direction = 0, 0, 0, expected a direction other than 0, 0, 0");
  EXPECT_EQ(error(up + frame), "scene.xml:2: emitter \"directional\": direction = 0, 1, 0, but to_world is given, too");
}

// Beyond these, radiance becomes infinite or photons are lost.
TEST(Emitters, AreNeitherTooBrightNorTooDim) {
  const SceneFolder folder;
  const auto read = [&](const std::string& value) {
    emitter<PointEmitterDescription>(folder, "point", "<rgb name=\"intensity\" value=\"" + value + "\"/>");
  };
  for (const char* value : {"0", "1e-20", "1e30", "0 1e-40 1"}) EXPECT_NO_THROW(read(value)) << value;
  const auto error = [&](const std::string& value) { return error_of([&] { read(value); }); };
  const std::string expected = ", expected 0 or from 1e-20 to 1e30 in the largest channel";
  EXPECT_EQ(error("0 1e-21 0"), "scene.xml:2: emitter \"point\": intensity = 0, 1e-21, 0" + expected);
  EXPECT_EQ(error("1 1e31 1"), "scene.xml:2: emitter \"point\": intensity = 1, 1e+31, 1" + expected);
}

TEST(Emitters, StandWhereTheyBelong) {
  const SceneFolder folder;
  EXPECT_EQ(error_of([&] { folder.read_xml("<emitter type=\"area\"/>"); }),
            "scene.xml:2: emitter \"area\" stands by itself, expected it inside a shape");
  EXPECT_EQ(error_of([&] { folder.read_xml("<shape type=\"sphere\"><emitter type=\"point\"/></shape>"); }),
            "scene.xml:2: emitter \"point\" stands inside a shape \"sphere\", expected it directly in the scene");
  EXPECT_EQ(error_of([&] { folder.read_xml("<emitter type=\"constant\"><rgb name=\"radiance\" value=\"-1\"/></emitter>"); }),
            "scene.xml:2: emitter \"constant\": radiance = -1, -1, -1, expected numbers of at least 0");
}

TEST(Cameras, MayBeMirroredButNotScaled) {
  const SceneFolder folder;
  const auto camera = [&](const std::string& inside) {
    return folder.read_whole_xml("<scene version=\"3.0.0\"><sensor type=\"perspective\">" + inside + "</sensor></scene>").camera;
  };
  EXPECT_LT(camera("<transform name=\"to_world\"><scale x=\"-1\"/></transform>").to_world.determinant(), 0);
  EXPECT_NE(error_of([&] {
              camera("<transform name=\"to_world\"><scale value=\"2\"/></transform>");
            }).find("scales or shears the camera"),
            std::string::npos);
  EXPECT_NE(error_of([&] { camera("<float name=\"fov\" value=\"180\"/>"); }).find("fov = 180, expected a number in (0, 180)"),
            std::string::npos);
  EXPECT_NE(error_of([&] {
              camera("<float name=\"near_clip\" value=\"2\"/><float name=\"far_clip\" value=\"1\"/>");
            }).find("expected more than near_clip = 2"),
            std::string::npos);
  EXPECT_NE(error_of([&] {
              camera("<float name=\"principal_point_offset_x\" value=\"0.1\"/>");
            }).find("is not supported yet, expected 0"),
            std::string::npos);
}

TEST(Cameras, WithALensNeedAnAperture) {
  const SceneFolder folder;
  const auto camera = [&](const std::string& inside) {
    return folder.read_whole_xml("<scene version=\"3.0.0\"><sensor type=\"thinlens\">" + inside + "</sensor></scene>").camera;
  };
  const std::string aperture = "<float name=\"aperture_radius\" value=\"0.25\"/>";
  EXPECT_FLOAT_EQ(camera(aperture).aperture_radius, 0.25f);
  EXPECT_FLOAT_EQ(camera(aperture + "<float name=\"far_clip\" value=\"77\"/>").focus_distance, 77);  // Mitsuba 3.6.4's, too
  const std::string text = describe(folder.read_whole_xml("<scene version=\"3.0.0\"><sensor type=\"thinlens\">" + aperture +
                                                          "<float name=\"focus_distance\" value=\"6\"/></sensor></scene>"));
  EXPECT_NE(text.find("lens 0.25 6\n"), std::string::npos) << text;
  EXPECT_EQ(text, describe(folder.read_json(R"({"type": "scene", "sensor":
    {"type": "thinlens", "aperture_radius": 0.25, "focus_distance": 6}})")));
  EXPECT_EQ(error_of([&] { camera(""); }), "scene.xml:1: sensor \"thinlens\": lacks the parameter \"aperture_radius\"");
  EXPECT_EQ(error_of([&] { camera("<float name=\"aperture_radius\" value=\"-1\"/>"); }),
            "scene.xml:1: sensor \"thinlens\": aperture_radius = -1, expected a number of at least 0");
  EXPECT_EQ(error_of([&] { camera(aperture + "<float name=\"focus_distance\" value=\"0\"/>"); }),
            "scene.xml:1: sensor \"thinlens\": focus_distance = 0, expected a number greater than 0");
}

}  // namespace
}  // namespace fluxfarm
