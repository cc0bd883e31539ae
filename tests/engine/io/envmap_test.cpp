// The image of an envmap: what is read from it, and one clear error for each way in which it can be wrong.
#include <cmath>
#include <limits>

#include "io/exr.h"
#include "io/scene_folder.h"

namespace fluxfarm {
namespace {

constexpr const char* kScene = "<emitter type=\"envmap\"><string name=\"filename\" value=\"maps/sky.exr\"/></emitter>";

// 2 x 3 pixels of those channels, the values counting up from `first`.
Image image_of(const std::vector<std::string>& channels, float first = 0) {
  Image image;
  image.width = 2;
  image.height = 3;
  image.data_window = {0, 0, 2, 3};
  for (const std::string& name : channels) {
    image.channels.push_back({name, {first, first + 1, first + 2, first + 3, first + 4, first + 5}});
    first += 10;
  }
  return image;
}

class EnvmapFile : public testing::Test {
 protected:
  EnvmapFile() { std::filesystem::create_directories(folder.path() / "maps"); }
  std::filesystem::path file() const { return folder.path() / "maps/sky.exr"; }

  EnvmapEmitterDescription read(const std::string& scene = kScene) const {
    return std::get<EnvmapEmitterDescription>(folder.read_xml(scene).emitters.at(1));
  }
  std::string error(const std::string& scene = kScene) const {
    return error_of([&] { read(scene); });
  }
  // The file's bytes with one byte changed by exclusive or.
  void flip(std::size_t at, char bits) const {
    std::ifstream stream(file(), std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    bytes.at(at) = static_cast<char>(bytes.at(at) ^ bits);
    folder.write("maps/sky.exr", bytes);
  }

  SceneFolder folder;
};

TEST_F(EnvmapFile, GivesItsColours) {
  write_exr(file(), image_of({"B", "G", "R"}));
  const LatLongImage image = read().image;
  EXPECT_EQ(image.width, 2);
  EXPECT_EQ(image.height, 3);
  ASSERT_EQ(image.pixels.size(), 6u);
  EXPECT_EQ(image.pixels[3], Rgb(23, 13, 3));
}

TEST_F(EnvmapFile, OtherChannelsDoNotMatter) {
  write_exr(file(), image_of({"A", "B", "G", "R", "depth.Z"}, -1));
  EXPECT_EQ(read().image.pixels[0], Rgb(29, 19, 9));
}

TEST_F(EnvmapFile, LuminanceAloneIsGrey) {
  write_exr(file(), image_of({"Y"}));
  EXPECT_EQ(read().image.pixels[4], Rgb(4));
}

TEST_F(EnvmapFile, IsScaledAndTurned) {
  write_exr(file(), image_of({"B", "G", "R"}));
  const auto map = read(
      "<emitter type=\"envmap\"><string name=\"filename\" value=\"maps/sky.exr\"/><float name=\"scale\" value=\"0.5\"/>"
      "<boolean name=\"mis_compensation\" value=\"true\"/>"
      "<transform name=\"to_world\"><rotate y=\"1\" angle=\"90\"/></transform></emitter>");
  EXPECT_EQ(map.image.pixels[3], Rgb(11.5f, 6.5f, 1.5f));
  EXPECT_NEAR(map.to_world.vector({0, 0, 1}).x, 1, 1e-6f);
}

TEST_F(EnvmapFile, ReadsTheSameFromJson) {
  write_exr(file(), image_of({"B", "G", "R"}));
  const SceneDescription scene = folder.read_json(
      R"({"type": "scene", "sensor": {"type": "perspective"}, "sky": {"type": "envmap", "filename": "maps/sky.exr", "scale": 2}})");
  EXPECT_EQ(std::get<EnvmapEmitterDescription>(scene.emitters.at(0)).image.pixels[3], Rgb(46, 26, 6));
}

TEST_F(EnvmapFile, MissingIsAnError) {
  EXPECT_EQ(error(), "scene.xml:2: file \"maps/sky.exr\" does not exist in the scene's folder");
  EXPECT_EQ(error("<emitter type=\"envmap\"/>"), "scene.xml:2: emitter \"envmap\": lacks the parameter \"filename\"");
}

TEST_F(EnvmapFile, OfAnotherKindIsAnError) {
  folder.write("maps/sky.exr", "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(error(), "maps/sky.exr: is no image for an envmap, expected OpenEXR or HDR");
  folder.write("maps/sky.exr", "");
  EXPECT_EQ(error(), "maps/sky.exr: is no image for an envmap, expected OpenEXR or HDR");
}

// Radiance's format: mantissas of red, green and blue and a common exponent, 128 + log2 of what 256 of a mantissa stand for.
std::string hdr(const std::string& size, int pixels) {
  std::string text = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + size + "\n";
  for (int i = 0; i < pixels; ++i) text += {static_cast<char>(64), static_cast<char>(32), static_cast<char>(16 + i), '\x8a'};
  return text;
}

TEST_F(EnvmapFile, OfRadiancesFormatGivesItsColours) {
  folder.write("maps/sky.exr", hdr("-Y 3 +X 2", 6));
  const LatLongImage image = read().image;
  EXPECT_EQ(image.width, 2);
  EXPECT_EQ(image.height, 3);
  ASSERT_EQ(image.pixels.size(), 6u);
  // The exponent 138 makes a mantissa m stand for 4 m; decoders differ by half a mantissa.
  EXPECT_NEAR(image.pixels[3].r, 256, 2);
  EXPECT_NEAR(image.pixels[3].g, 128, 2);
  EXPECT_NEAR(image.pixels[3].b, 76, 2);
  EXPECT_GT(image.pixels[3].r, 255) << "no clamping to what a screen can show";
}

TEST_F(EnvmapFile, OfRadiancesFormatThatIsWrongIsAnError) {
  folder.write("maps/sky.exr", "#?RADIANCE\n");
  EXPECT_EQ(error().find("maps/sky.exr: is a damaged hdr image: "), 0u) << error();
  folder.write("maps/sky.exr", hdr("-Y 3 +X 2", 3));
  EXPECT_EQ(error().find("maps/sky.exr: is a damaged hdr image: "), 0u) << error();
  EXPECT_EQ(error().find(folder.path().string()), std::string::npos) << error();
  folder.write("maps/sky.exr", hdr("-Y 2 +X 3", 6));
  EXPECT_EQ(error(), "maps/sky.exr: has 3 x 2 pixels, expected at least 2 x 3 for an envmap");
  folder.write("maps/sky.exr", hdr("+Y 3 +X 2", 6));
  EXPECT_NE(error(), "") << "rows from the bottom";
  folder.write("maps/sky.exr", hdr("-Y 60000 +X 60000", 6));
  EXPECT_EQ(error().find("maps/sky.exr: the image has 60000 x 60000 pixels, expected "), 0u) << error();
}

TEST_F(EnvmapFile, DeepIsAnError) {
  write_exr(file(), image_of({"B", "G", "R"}));
  flip(5, 0x08);  // the bit of the version field that says so
  EXPECT_EQ(error(), "maps/sky.exr: is a deep OpenEXR image, expected a flat one");
}

TEST_F(EnvmapFile, DamagedIsAnErrorUnderItsOwnName) {
  write_exr(file(), image_of({"B", "G", "R"}));
  std::filesystem::resize_file(file(), std::filesystem::file_size(file()) - 20);
  const std::string text = error();
  EXPECT_EQ(text.find("maps/sky.exr: cannot be read as EXR: "), 0u) << text;
  EXPECT_EQ(text.find(folder.path().string()), std::string::npos) << text;
}

TEST_F(EnvmapFile, WithBadValuesIsAnError) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  for (const auto& [value, text] : {std::pair{nan, "nan"}, {-0.5f, "-0.5"}, {infinity, "inf"}}) {
    Image image = image_of({"B", "G", "R"});
    image.channels[1].values[3] = value;
    write_exr(file(), image);
    EXPECT_EQ(error(), std::string("maps/sky.exr: pixel (1, 1): G = ") + text + ", expected a finite number of at least 0");
  }
}

TEST_F(EnvmapFile, ThatScalesToInfinityIsAnError) {
  write_exr(file(), image_of({"B", "G", "R"}, 1e30f));
  EXPECT_EQ(error("<emitter type=\"envmap\"><string name=\"filename\" value=\"maps/sky.exr\"/>"
                  "<float name=\"scale\" value=\"1e20\"/></emitter>"),
            "scene.xml:2: emitter \"envmap\": scale = 1e+20, makes the image's radiance infinite, expected a smaller number");
}

TEST_F(EnvmapFile, TooSmallIsAnError) {
  Image image = image_of({"B", "G", "R"});
  image.width = 1;
  image.height = 1;
  image.data_window = {0, 0, 1, 1};
  for (ImageChannel& channel : image.channels) channel.values = {1};
  write_exr(file(), image);
  EXPECT_EQ(error(), "maps/sky.exr: has 1 x 1 pixels, expected at least 2 x 3 for an envmap");
}

TEST_F(EnvmapFile, WithoutPixelsIsAnError) {
  write_exr(file(), image_of({"B", "G", "R"}));
  // The data window's right edge moves to the left of its left edge.
  std::ifstream stream(file(), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  const std::string attribute = std::string("dataWindow") + '\0' + "box2i" + '\0';
  const std::size_t x_max = bytes.find(attribute) + attribute.size() + 4 + 8;
  flip(x_max, static_cast<char>(0xfe));  // from 1 to -1
  for (const std::size_t i : {1, 2, 3}) flip(x_max + i, static_cast<char>(0xff));
  EXPECT_EQ(error().find("maps/sky.exr: cannot be read as EXR: "), 0u) << error();
}

TEST_F(EnvmapFile, ThatIsAPartOfAFrameIsAnError) {
  Image image = image_of({"B", "G", "R"});
  image.width = 20;
  write_exr(file(), image);
  EXPECT_EQ(error(), "maps/sky.exr: holds 2 x 3 pixels of a frame of 20 x 3 pixels, expected the whole frame");
}

TEST_F(EnvmapFile, WithoutColoursIsAnError) {
  write_exr(file(), image_of({"G", "R"}));
  EXPECT_EQ(error(), "maps/sky.exr: lacks a channel, expected R, G and B, or Y alone");
}

TEST_F(EnvmapFile, SecondOneIsAnError) {
  write_exr(file(), image_of({"B", "G", "R"}));
  EXPECT_EQ(error(std::string(kScene) + "\n" + kScene), "scene.xml:3: the scene has a second envmap; the first is at scene.xml:2");
}

TEST_F(EnvmapFile, DistortedIsAnError) {
  write_exr(file(), image_of({"B", "G", "R"}));
  EXPECT_NE(error("<emitter type=\"envmap\"><string name=\"filename\" value=\"maps/sky.exr\"/>"
                  "<transform name=\"to_world\"><scale y=\"2\"/></transform></emitter>")
                .find("stretches or shears the light"),
            std::string::npos);
}

TEST_F(EnvmapFile, BlackOneIsNoLight) {
  Image image = image_of({"Y"});
  image.channels[0].values.assign(6, 0.0f);
  write_exr(file(), image);
  const SceneDescription scene =
      folder.read_whole_xml("<scene version=\"3.0.0\"><sensor type=\"perspective\"/>" + std::string(kScene) + "</scene>");
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(scene.warnings[0], "scene.xml:1: no light: the image will be black");
}

}  // namespace
}  // namespace fluxfarm
