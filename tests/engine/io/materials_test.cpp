// Parameters of `principled` and of the materials that hold others: defaults, ranges and mistakes.
#include <gtest/gtest.h>

#include "io/exr.h"
#include "scene_folder.h"

namespace fluxfarm {
namespace {

class MaterialScenes : public testing::Test {
 protected:
  MaterialScenes() {
    Image image;
    image.width = image.height = 1;
    image.data_window = {0, 0, 1, 1};
    image.channels = {{"B", {0.1f}}, {"G", {0.2f}}, {"R", {0.3f}}};
    write_exr(folder_.path() / "a.exr", image);
  }

  // Of a sphere with that bsdf; the last of `materials` is its own.
  SceneDescription read(const std::string& bsdf) const { return folder_.read_xml("<shape type=\"sphere\">" + bsdf + "</shape>"); }
  template <class Description>
  Description last(const std::string& bsdf) const {
    return std::get<Description>(read(bsdf).materials.back());
  }
  std::string error(const std::string& bsdf) const {
    return error_of([&] { read(bsdf); });
  }
  static std::string bsdf(const std::string& type, const std::string& inside) {
    return "<bsdf type=\"" + type + "\">" + inside + "</bsdf>";
  }
  static std::string number(const std::string& name, const std::string& value) {
    return "<float name=\"" + name + "\" value=\"" + value + "\"/>";
  }
  static std::string bitmap(const std::string& name) {
    return "<texture type=\"bitmap\" name=\"" + name + "\"><string name=\"filename\" value=\"a.exr\"/></texture>";
  }

  SceneFolder folder_;
};

TEST_F(MaterialScenes, PrincipledHasMitsubasDefaults) {
  const auto d = last<PrincipledDescription>(bsdf("principled", ""));
  EXPECT_EQ(d.base_color, Rgb(0.5f));
  EXPECT_EQ(d.roughness.factor, 0.5f);
  EXPECT_EQ(d.metallic.factor, 0);
  EXPECT_EQ(d.base_color_texture, kNoTexture);
  EXPECT_NEAR(d.eta, 1.5f, 1e-6f);
}

TEST_F(MaterialScenes, PrincipledTakesEveryParameter) {
  std::string all = number("base_color", "0.9");
  const char* names[] = {"roughness", "anisotropic", "metallic", "spec_trans", "spec_tint",
                         "sheen",     "sheen_tint",  "flatness", "clearcoat",  "clearcoat_gloss"};
  for (int i = 0; i < 10; ++i) all += number(names[i], "0.0" + std::to_string(i + 1).substr(0, 1));
  const auto d =
      last<PrincipledDescription>(bsdf("principled", all + number("eta", "1.7") + number("clearcoat_sampling_rate", "2")));
  EXPECT_EQ(d.base_color, Rgb(0.9f));
  EXPECT_EQ(d.roughness.factor, 0.01f);
  EXPECT_EQ(d.spec_trans.factor, 0.04f);
  EXPECT_EQ(d.clearcoat.factor, 0.09f);
  EXPECT_EQ(d.clearcoat_gloss.factor, 0.01f);
  EXPECT_EQ(d.eta, 1.7f);
}

TEST_F(MaterialScenes, EveryParameterOfPrincipledButEtaMayBeATexture) {
  const auto d = last<PrincipledDescription>(bsdf("principled", bitmap("base_color") + bitmap("roughness") + bitmap("metallic")));
  EXPECT_EQ(d.base_color, Rgb(1));
  EXPECT_EQ(d.base_color_texture, 0);
  EXPECT_EQ(d.roughness.factor, 1);
  EXPECT_EQ(d.roughness.texture, 1);
  EXPECT_EQ(d.metallic.texture, 2);
  EXPECT_EQ(
      error(bsdf("principled", bitmap("eta"))).find("scene.xml:2: bsdf \"principled\" cannot hold a texture \"bitmap\" as \"eta\""),
      0u);
}

TEST_F(MaterialScenes, SpecularIsTheReflectanceOfAnIndex) {
  EXPECT_NEAR(last<PrincipledDescription>(bsdf("principled", number("specular", "1"))).eta, 1.7887885f, 1e-6f);
  EXPECT_EQ(last<PrincipledDescription>(bsdf("principled", number("specular", "0"))).eta, 1);
  EXPECT_GT(last<PrincipledDescription>(bsdf("principled", number("specular", "0") + number("spec_trans", "1"))).eta, 1.01f);
}

TEST_F(MaterialScenes, MistakesInPrincipledAreNamed) {
  EXPECT_EQ(error(bsdf("principled", number("roughness", "1.5"))),
            "scene.xml:2: bsdf \"principled\": roughness = 1.5, expected a number in [0, 1]");
  EXPECT_EQ(error(bsdf("principled", number("sheen_tint", "-0.1"))),
            "scene.xml:2: bsdf \"principled\": sheen_tint = -0.1, expected a number in [0, 1]");
  EXPECT_EQ(error(bsdf("principled", number("eta", "0"))),
            "scene.xml:2: bsdf \"principled\": eta = 0, expected a number greater than 0");
  EXPECT_EQ(error(bsdf("principled", number("eta", "1.5") + number("specular", "0.5"))),
            "scene.xml:2: bsdf \"principled\": specular = 0.5, but eta is given, too; expected one or the other");
  EXPECT_EQ(error(bsdf("principled", number("metalic", "1"))).find("scene.xml:2: bsdf \"principled\" has no parameter \"metalic\""),
            0u);
  EXPECT_EQ(error("<bsdf type=\"twosided\">" + bsdf("principled", number("spec_trans", "0.5")) + "</bsdf>"),
            "scene.xml:2: bsdf \"twosided\" holds a material that transmits light, expected an opaque one");
}

const std::string kDiffuse = "<bsdf type=\"diffuse\"/>";

TEST_F(MaterialScenes, MaskCoversAShare) {
  const SceneDescription scene = read(bsdf("mask", kDiffuse));
  const auto mask = std::get<MaskDescription>(scene.materials.at(static_cast<std::size_t>(scene.shapes[0].material)));
  EXPECT_EQ(mask.opacity.factor, 0.5f);
  EXPECT_TRUE(std::holds_alternative<DiffuseDescription>(scene.materials.at(static_cast<std::size_t>(mask.material))));
  const auto leaf = last<MaskDescription>(bsdf("mask", bitmap("opacity") + kDiffuse));
  EXPECT_EQ(leaf.opacity.factor, 1);
  EXPECT_EQ(leaf.opacity.texture, 0);
}

TEST_F(MaterialScenes, BlendTakesItsBsdfsInOrder) {
  const SceneDescription scene = read(bsdf("blendbsdf", number("weight", "0.2") + kDiffuse + "<bsdf type=\"plastic\"/>"));
  const auto blend = std::get<BlendDescription>(scene.materials.back());
  EXPECT_EQ(blend.weight.factor, 0.2f);
  EXPECT_TRUE(std::holds_alternative<DiffuseDescription>(scene.materials.at(static_cast<std::size_t>(blend.first))));
  EXPECT_TRUE(std::holds_alternative<PlasticDescription>(scene.materials.at(static_cast<std::size_t>(blend.second))));
}

TEST_F(MaterialScenes, MapsTakeATextureAndABsdf) {
  const auto normals = last<NormalMapDescription>(bsdf("normalmap", bitmap("normalmap") + kDiffuse));
  EXPECT_EQ(normals.normals_texture, 0);
  const auto bumps = last<BumpMapDescription>(bsdf("bumpmap", number("scale", "-2") + bitmap("any") + kDiffuse));
  EXPECT_EQ(bumps.height_texture, 0);
  EXPECT_EQ(bumps.scale, -2);
}

TEST_F(MaterialScenes, ThinGlassAndNothingAreRead) {
  EXPECT_NEAR(last<ThinDielectricDescription>(bsdf("thindielectric", "")).dielectric.eta, 1.5041833f, 1e-6f);
  EXPECT_TRUE(std::holds_alternative<NullDescription>(read(bsdf("null", "")).materials.back()));
}

TEST_F(MaterialScenes, MaterialsNestAsMitsubaAllows) {
  const std::string principled = bsdf("principled", bitmap("base_color"));
  EXPECT_NO_THROW(read(bsdf("mask", bsdf("twosided", bsdf("bumpmap", bitmap("b") + principled)))));
  EXPECT_NO_THROW(read(bsdf("twosided", bsdf("blendbsdf", number("weight", "0.5") + principled + kDiffuse))));
  const std::string opaque = ": bsdf \"twosided\" holds a material that transmits light, expected an opaque one";
  for (const std::string& inside : {bsdf("mask", kDiffuse), bsdf("null", ""), bsdf("thindielectric", ""),
                                    bsdf("blendbsdf", number("weight", "0.5") + kDiffuse + bsdf("null", "")),
                                    bsdf("normalmap", bitmap("normalmap") + "<bsdf type=\"dielectric\"/>"),
                                    bsdf("bumpmap", bitmap("b") + "<bsdf type=\"dielectric\"/>")}) {
    EXPECT_EQ(error(bsdf("twosided", inside)), "scene.xml:2" + opaque) << inside;
  }
}

TEST_F(MaterialScenes, MistakesInMaterialsThatHoldOthersAreNamed) {
  EXPECT_EQ(error(bsdf("mask", "")), "scene.xml:2: bsdf \"mask\" holds 0 bsdfs, expected one");
  EXPECT_EQ(error(bsdf("mask", kDiffuse + kDiffuse)), "scene.xml:2: bsdf \"mask\" holds 2 bsdfs, expected one");
  EXPECT_EQ(error(bsdf("mask", number("opacity", "1.2") + kDiffuse)),
            "scene.xml:2: bsdf \"mask\": opacity = 1.2, expected a number in [0, 1]");
  EXPECT_EQ(error(bsdf("mask", bitmap("alpha") + kDiffuse)),
            "scene.xml:2: bsdf \"mask\" cannot hold a texture \"bitmap\"; it takes one bsdf and a texture named opacity");
  EXPECT_EQ(error(bsdf("blendbsdf", kDiffuse + kDiffuse)), "scene.xml:2: bsdf \"blendbsdf\": lacks the parameter \"weight\"");
  EXPECT_EQ(error(bsdf("blendbsdf", number("weight", "0.5") + kDiffuse)),
            "scene.xml:2: bsdf \"blendbsdf\" holds 1 bsdfs, expected two");
  EXPECT_EQ(error(bsdf("normalmap", kDiffuse)), "scene.xml:2: bsdf \"normalmap\" lacks a texture named \"normalmap\"");
  EXPECT_EQ(error(bsdf("bumpmap", kDiffuse)), "scene.xml:2: bsdf \"bumpmap\" lacks a texture, expected one texture and one bsdf");
  EXPECT_EQ(error(bsdf("bumpmap", bitmap("b"))), "scene.xml:2: bsdf \"bumpmap\" lacks a bsdf, expected one texture and one bsdf");
  EXPECT_EQ(error(bsdf("bumpmap", "<texture type=\"checkerboard\" name=\"b\"/>" + kDiffuse)),
            "scene.xml:2: bsdf \"bumpmap\": the texture has no slope, expected a bitmap with filter_type bilinear");
  EXPECT_EQ(error(bsdf("bumpmap", number("scale", "1e999") + bitmap("b") + kDiffuse)).find("scene.xml:2"), 0u);
  EXPECT_EQ(error(bsdf("null", number("opacity", "1"))), "scene.xml:2: bsdf \"null\" has no parameter \"opacity\"; it takes none");
}

class ColouredMeshes : public MaterialScenes {
 protected:
  // A triangle with that colour of the first vertex.
  SceneDescription read_ply(const std::string& property, const std::string& colour, const std::string& material) const {
    const auto line = [&](const char* name) { return "property " + property + " " + name + "\n"; };
    folder_.write("c.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" +
                               line("red") + line("green") + line("blue") +
                               "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 " + colour +
                               "\n1 0 0 0 0 0\n0 1 0 0 0 0\n3 0 1 2\n");
    return folder_.read_xml("<shape type=\"ply\"><string name=\"filename\" value=\"c.ply\"/>" + material + "</shape>");
  }
  static std::string painted(const std::string& attribute = "vertex_color", const std::string& more = "") {
    return bsdf("diffuse", "<texture type=\"mesh_attribute\" name=\"reflectance\"><string name=\"name\" value=\"" + attribute +
                               "\"/>" + more + "</texture>");
  }
  static const std::vector<Rgb>& colors(const SceneDescription& scene) {
    return std::get<MeshDescription>(scene.shapes.at(0).geometry).colors;
  }
};

TEST_F(ColouredMeshes, PlyColoursAreReadWhereTheMaterialShowsThem) {
  const SceneDescription scene = read_ply("float", "0.2 0.4 0.8", painted("vertex_color", number("scale", "0.5")));
  ASSERT_EQ(colors(scene).size(), 3u);
  EXPECT_EQ(colors(scene)[0], Rgb(0.2f, 0.4f, 0.8f));
  EXPECT_EQ(std::get<MeshAttributeDescription>(scene.textures.at(0)).scale, 0.5f);
  EXPECT_EQ(colors(read_ply("uchar", "255 51 0", painted()))[0], Rgb(1, 0.2f, 0)) << "integers are parts of their greatest";
  EXPECT_TRUE(colors(read_ply("float", "0.2 0.4 0.8", kDiffuse)).empty());
}

TEST_F(ColouredMeshes, MistakesAreNamed) {
  EXPECT_EQ(error_of([&] { read_ply("float", "0 0 0", painted("face_color")); }),
            "scene.xml:2: texture \"mesh_attribute\": name = \"face_color\", expected vertex_color");
  EXPECT_EQ(error(bsdf("diffuse", "<texture type=\"mesh_attribute\" name=\"reflectance\"/>")),
            "scene.xml:2: texture \"mesh_attribute\": lacks the parameter \"name\"");
}

}  // namespace
}  // namespace fluxfarm
