// Parameters of `principled`: defaults, ranges and mistakes.
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

}  // namespace
}  // namespace fluxfarm
