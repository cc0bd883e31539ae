// EXR and PNG files.
#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "io/exr.h"
#include "io/png.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) / ("fluxfarm-io-" + name);
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// A tile in the middle of a larger frame.
Image tile() {
  Image image;
  image.width = 64;
  image.height = 48;
  image.data_window = {16, 8, 3, 2};
  image.channels = {{"B", {1, 2, 3, 4, 5, 6}},
                    {"G", {0, -1, 1e-30f, 1e30f, 0.1f, 65536.5f}},
                    {"R", {0.0f, 0.0031308f, 0.18f, 0.5f, 1.0f, std::numeric_limits<float>::quiet_NaN()}},
                    {"error.noise", {1, 1, 2, 2, 3, 3}}};
  image.attributes = {{"integrator", std::string("path")}, {"seconds", 1.5f}, {"seed", 7}};
  return image;
}

TEST(Exr, RoundTripKeepsWindowsChannelsAndAttributes) {
  const std::filesystem::path path = temporary("round-trip.exr");
  const Image written = tile();
  write_exr(path, written);
  const Image read = read_exr(path);
  EXPECT_EQ(read.width, 64);
  EXPECT_EQ(read.height, 48);
  EXPECT_EQ(read.data_window, written.data_window);
  EXPECT_EQ(read.attributes, written.attributes);
  ASSERT_EQ(read.channels.size(), 4u);
  for (const ImageChannel& channel : written.channels) {
    const std::vector<float>* values = read.find(channel.name);
    ASSERT_NE(values, nullptr) << channel.name;
    for (std::size_t i = 0; i < 6; ++i) {
      const bool both_nan = std::isnan(channel.values[i]) && std::isnan((*values)[i]);
      EXPECT_TRUE(both_nan || (*values)[i] == channel.values[i]) << channel.name << " " << i;
    }
  }
}

TEST(Exr, EqualImagesGiveEqualBytes) {
  write_exr(temporary("a.exr"), tile());
  write_exr(temporary("b.exr"), tile());
  EXPECT_EQ(bytes_of(temporary("a.exr")), bytes_of(temporary("b.exr")));
}

TEST(Exr, FilesThatCannotBeWrittenOrReadAreErrors) {
  EXPECT_THROW(write_exr(temporary("no-such-folder") / "a.exr", tile()), ResourceError);
  EXPECT_THROW(read_exr(temporary("no-such-file.exr")), ResourceError);
  std::ofstream(temporary("text.exr")) << "this is no image";
  EXPECT_THROW(read_exr(temporary("text.exr")), ResourceError);
}

TEST(Png, EncodesLinearLightAsSrgb) {
  EXPECT_EQ(srgb_byte(-1), 0);
  EXPECT_EQ(srgb_byte(0.0031308f), 10);  // 12.92 * 0.0031308 * 255 = 10.3
  EXPECT_EQ(srgb_byte(0.18f), 118);      // (1.055 * 0.18^(1/2.4) - 0.055) * 255 = 117.7
  EXPECT_EQ(srgb_byte(0.5f), 188);
  EXPECT_EQ(srgb_byte(1), 255);
  EXPECT_EQ(srgb_byte(1e30f), 255);
  EXPECT_EQ(srgb_byte(std::numeric_limits<float>::quiet_NaN()), 0);
}

TEST(Png, DecodesToTheExpectedValues) {
  const std::filesystem::path path = temporary("beauty.png");
  write_png(path, tile());
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_file(&png, path.c_str()));
  EXPECT_EQ(png.width, 3u);
  EXPECT_EQ(png.height, 2u);
  png.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(png));
  ASSERT_TRUE(png_image_finish_read(&png, nullptr, bytes.data(), 0, nullptr));
  EXPECT_EQ(bytes, (std::vector<std::uint8_t>{0, 0, 255, 10, 0, 255, 118, 0, 255, 188, 255, 255, 255, 89, 255, 0, 255, 255}));
}

TEST(Png, NeedsTheBeauty) {
  Image image = tile();
  image.channels.erase(image.channels.begin());
  EXPECT_THROW(write_png(temporary("none.png"), image), SettingError);
}

}  // namespace
}  // namespace fluxfarm
