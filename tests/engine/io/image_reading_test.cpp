// Images for textures: what comes out of each format, and one clear error for each bad file.
#include <cmath>
#include <limits>

#include "io/exr.h"
#include "io/limits.h"
#include "io/read_image.h"
#include "scene_folder.h"

// Read by the leak sanitizer: OpenImageIO 2.4 loses its words (31 bytes) about a damaged PNG.
extern "C" const char* __lsan_default_suppressions() { return "leak:libOpenImageIO"; }

namespace fluxfarm {
namespace {

TextureImage read(const std::filesystem::path& file, bool raw = false) { return read_image(file, file.filename().string(), raw); }

std::filesystem::path stored(const std::string& name) { return std::filesystem::path(__FILE__).parent_path() / "images" / name; }

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// Two by two pixels with those channels; the values count up from 0.05 in steps of 0.05, channel by channel.
Image exr(const std::vector<std::string>& channels) {
  Image image;
  image.width = image.height = 2;
  image.data_window = {0, 0, 2, 2};
  float value = 0;
  for (const std::string& name : channels) {
    image.channels.push_back({name, {}});
    for (int i = 0; i < 4; ++i) image.channels.back().values.push_back(value += 0.05f);
  }
  return image;
}

class Images : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const Image& image) const {
    write_exr(folder_.path() / name, image);
    return folder_.path() / name;
  }
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    folder_.write(name, bytes);
    return folder_.path() / name;
  }

  SceneFolder folder_;
};

std::string read_error(const std::filesystem::path& file) {
  return error_of([&] { read(file); });
}

TEST_F(Images, FloatsOfAnExrAreTakenAsTheyAre) {
  // Written in the order that EXR keeps, by name; R, G and B are found among others.
  const TextureImage image = read(write("a.exr", exr({"A", "B", "G", "R", "Z"})));
  EXPECT_EQ(image.width(), 2);
  EXPECT_FLOAT_EQ(image.texel(0, 0).b, 0.25f);
  EXPECT_FLOAT_EQ(image.texel(0, 0).g, 0.45f);
  EXPECT_FLOAT_EQ(image.texel(0, 0).r, 0.65f);
  EXPECT_FLOAT_EQ(image.texel(1, 0).r, 0.7f);
  EXPECT_FLOAT_EQ(image.texel(0, 1).r, 0.75f) << "rows run down";
  const TextureImage grey = read(write("y.exr", exr({"Y"})));
  EXPECT_EQ(grey.texel(1, 1), Rgb(0.2f));
}

TEST_F(Images, AlphaComesWithTheColours) {
  const ImageAndAlpha both = read_image_and_alpha(write("a.exr", exr({"A", "B", "G", "R", "Z"})), "a.exr");
  EXPECT_FLOAT_EQ(both.colors.texel(0, 0).b, 0.25f);
  EXPECT_FLOAT_EQ(both.colors.texel(1, 1).r, 0.8f);
  ASSERT_TRUE(both.alpha.has_value());
  EXPECT_FLOAT_EQ(both.alpha->texel(0, 0).g, 0.05f);
  EXPECT_FLOAT_EQ(both.alpha->texel(1, 1).g, 0.2f);
  const ImageAndAlpha grey = read_image_and_alpha(write("grey.exr", exr({"A", "Y"})), "grey.exr");
  EXPECT_FLOAT_EQ(grey.colors.texel(1, 1).g, 0.4f);
  EXPECT_FLOAT_EQ(grey.alpha.value().texel(1, 1).g, 0.2f);
  EXPECT_FALSE(read_image_and_alpha(write("rgb.exr", exr({"B", "G", "R"})), "rgb.exr").alpha.has_value());
}

TEST_F(Images, RadiancePicturesAreLinear) {
  // Two pixels, not run-length coded: (128, 64, 32) and (255, 0, 255) with exponents 2^(128 - 136) and 2^(127 - 136).
  const std::string pixels{"\x80\x40\x20\x80\xff\x00\xff\x7f", 8};
  const TextureImage image = read(write("a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" + pixels));
  EXPECT_NEAR(image.texel(0, 0).r, 0.5f, 2e-3f);
  EXPECT_NEAR(image.texel(0, 0).b, 0.125f, 2e-3f);
  EXPECT_NEAR(image.texel(1, 0).r, 0.498f, 2e-3f);
}

TEST_F(Images, PngOfSixteenBitsIsDecodedFromSrgbUnlessRaw) {
  EXPECT_NEAR(read(stored("grey16.png")).texel(0, 1).g, 0.21404f, 1e-5f);
  EXPECT_NEAR(read(stored("grey16.png"), true).texel(0, 1).g, 0.50001f, 1e-5f);
  EXPECT_EQ(read(stored("grey16.png")).texel(1, 0), Rgb(1.0f));
}

TEST_F(Images, AlphaIsLeftOutAndDoesNotDarken) {
  const TextureImage image = read(stored("transparent.png"), true);
  EXPECT_FLOAT_EQ(image.texel(0, 0).r, 1);
  EXPECT_FLOAT_EQ(image.texel(0, 0).g, 128 / 255.0f);
  EXPECT_FLOAT_EQ(image.texel(1, 0).b, 30 / 255.0f);
}

TEST_F(Images, JpegIsDecodedFromSrgb) {
  const TextureImage image = read(stored("orange.jpg"));
  EXPECT_EQ(image.width(), 8);
  EXPECT_NEAR(image.texel(4, 4).r, 0.5776f, 0.02f);  // 200
  EXPECT_NEAR(image.texel(4, 4).g, 0.1274f, 0.02f);  // 100
  EXPECT_NEAR(image.texel(4, 4).b, 0.0319f, 0.02f);  // 50
}

TEST_F(Images, WhatIsNoImageIsNamed) {
  EXPECT_EQ(read_error(write("a.png", "hello")), "a.png: is no image that can be read, expected EXR, HDR, PNG or JPEG");
  EXPECT_EQ(read_error(write("empty.exr", "")), "empty.exr: is no image that can be read, expected EXR, HDR, PNG or JPEG");
  EXPECT_EQ(read_error(write("cut.png", std::string("\x89PNG\r\n\x1a\n", 8))).find("cut.png: is a damaged png image: "), 0u);
}

TEST_F(Images, CutFilesAreDamaged) {
  const auto cut = [&](const std::string& name, const std::filesystem::path& whole) {
    const std::string bytes = bytes_of(whole);
    return read_error(write(name, bytes.substr(0, bytes.size() * 2 / 3)));
  };
  EXPECT_NE(cut("cut.exr", write("whole.exr", exr({"B", "G", "R"}))).find("cut.exr: is a damaged openexr image: "),
            std::string::npos);
  EXPECT_NE(cut("cut.png", stored("grey16.png")).find("cut.png: is a damaged png image: "), std::string::npos);
}

TEST_F(Images, DeepExrIsRefused) {
  EXPECT_EQ(read_error(stored("deep.exr")), "deep.exr: is a deep image, expected one value a pixel");
}

TEST_F(Images, ClaimsOfManyPixelsAreRefusedBeforeMemoryIsTaken) {
  const std::string size = "the image has 60000 x 60000 pixels, expected sides of 1 to 65536 and at most 134217728 pixels";
  EXPECT_EQ(read_error(stored("bomb.png")), "bomb.png: " + size);
  // Start of image, an empty segment, a stray byte, and a progressive frame header of 60000 x 60000.
  const std::string jpeg{
      "\xff\xd8\xff\xe0\x00\x04xx\x00\xff\xff\xc2\x00\x11\x08\xea\x60\xea\x60\x03\x01\x22\x00\x02\x11\x01\x03\x11\x01", 29};
  EXPECT_EQ(read_error(write("bomb.jpg", jpeg)), "bomb.jpg: " + size);
  EXPECT_EQ(read_error(write("bomb.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\n")), "bomb.hdr: " + size);

  std::string bytes = bytes_of(write("whole.exr", exr({"B", "G", "R"})));
  const std::size_t window = bytes.find(std::string("dataWindow\0box2i\0", 17));
  ASSERT_NE(window, std::string::npos);
  bytes.replace(window + 17 + 4 + 8, 8, std::string("\x5f\xea\x00\x00\x5f\xea\x00\x00", 8));  // 59999, 59999
  bytes.append(30000, '\0');                                                                  // room for the table of its blocks
  EXPECT_EQ(read_error(write("bomb.exr", bytes)), "bomb.exr: " + size);
}

TEST_F(Images, OtherChannelsAreNamed) {
  EXPECT_EQ(read_error(write("a.exr", exr({"U", "V", "W"}))),
            "a.exr: the image has the channels \"U, V, W\", expected R, G and B, or one");
  // An empty list of channels instead of the one with Y.
  std::string bytes = bytes_of(write("y.exr", exr({"Y"})));
  const std::size_t list = bytes.find(std::string("channels\0chlist\0", 16));
  ASSERT_NE(list, std::string::npos);
  bytes.replace(list + 16, 4 + 19, std::string("\x01\0\0\0\0", 5));
  const std::string none = read_error(write("none.exr", bytes));
  EXPECT_EQ(none.find("none.exr: is a damaged openexr image: "), 0u) << none;
  EXPECT_NE(none.find("empty channel list"), std::string::npos) << none;
}

TEST_F(Images, TexelsThatAreNoReflectanceAreNamed) {
  Image image = exr({"B", "G", "R"});
  image.channels[2].values[3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(read_error(write("nan.exr", image)),
            "nan.exr: pixel (1, 1) has the value nan, expected numbers in [0, 1]: a reflectance");
  image.channels[2].values[3] = 1.5f;
  EXPECT_EQ(read_error(write("bright.exr", image)),
            "bright.exr: pixel (1, 1) has the value 1.5, expected numbers in [0, 1]: a reflectance");
}

}  // namespace
}  // namespace fluxfarm
