// Look-ups of textures against values worked out by hand (and, for the bitmap's wrapping and filters, printed by Mitsuba 3.6.4).
#include <gtest/gtest.h>

#include <limits>

#include "textures/make_texture.h"

namespace fluxfarm::testing {
namespace {

std::unique_ptr<Texture> make(const TextureDescription& description) { return std::move(make_textures({description})[0]); }

// Three columns, two rows: 0.1 0.2 0.3 above 0.4 0.5 0.6.
std::shared_ptr<const TextureImage> grey_image() {
  return std::make_shared<const TextureImage>(3, 2, 1, std::vector<float>{0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f});
}

struct Lookups {
  TextureFilter filter;
  TextureWrap wrap;
  std::vector<float> expected;  // at kPlaces
};

constexpr Vec2f kPlaces[] = {{0.1f, 0.1f}, {0.1f, 0.9f}, {0.9f, 0.1f},   {0.5f, 0.5f}, {0, 0},
                             {1, 1},       {1.1f, 0.1f}, {-0.1f, -0.2f}, {2.3f, 1.7f}};

TEST(Bitmap, WrapsAndFiltersAsMitsubaDoes) {
  const Lookups cases[] = {
      {TextureFilter::kNearest, TextureWrap::kRepeat, {0.1f, 0.4f, 0.3f, 0.5f, 0.1f, 0.1f, 0.1f, 0.6f, 0.4f}},
      {TextureFilter::kBilinear, TextureWrap::kRepeat, {0.23f, 0.35f, 0.35f, 0.35f, 0.35f, 0.35f, 0.23f, 0.53f, 0.41f}},
      {TextureFilter::kNearest, TextureWrap::kMirror, {0.1f, 0.4f, 0.3f, 0.5f, 0.1f, 0.6f, 0.3f, 0.1f, 0.1f}},
      {TextureFilter::kBilinear, TextureWrap::kMirror, {0.1f, 0.4f, 0.3f, 0.35f, 0.1f, 0.6f, 0.3f, 0.1f, 0.17f}},
      {TextureFilter::kNearest, TextureWrap::kClamp, {0.1f, 0.4f, 0.3f, 0.5f, 0.1f, 0.6f, 0.3f, 0.1f, 0.6f}},
      {TextureFilter::kBilinear, TextureWrap::kClamp, {0.1f, 0.4f, 0.3f, 0.35f, 0.1f, 0.6f, 0.3f, 0.1f, 0.6f}}};
  for (const Lookups& c : cases) {
    const auto bitmap = make(BitmapDescription{grey_image(), c.filter, c.wrap, {}});
    for (std::size_t i = 0; i < std::size(kPlaces); ++i) {
      SCOPED_TRACE(::testing::Message() << "filter " << static_cast<int>(c.filter) << " wrap " << static_cast<int>(c.wrap) << " at "
                                        << kPlaces[i].x << ", " << kPlaces[i].y);
      EXPECT_NEAR(bitmap->value({kPlaces[i]}).g, c.expected[i], 2e-6f);
    }
  }
}

TEST(Bitmap, GradientIsTheSlopeOfTheBilinearSurface) {
  const Transform turned = Transform::rotate(0, 0, 1, 30) * Transform::scale(1.5, 0.7, 1);
  for (const TextureWrap wrap : {TextureWrap::kRepeat, TextureWrap::kMirror, TextureWrap::kClamp}) {
    const auto bitmap = make(BitmapDescription{grey_image(), TextureFilter::kBilinear, wrap, turned});
    for (const Vec2f uv : {Vec2f{0.31f, 0.42f}, {-0.4f, 0.3f}, {0.9f, 1.3f}, {0.55f, -0.21f}}) {
      constexpr float kStep = 1e-3f;
      const auto slope = [&](Vec2f d) {
        const Vec2f above{uv.x + d.x * kStep, uv.y + d.y * kStep}, below{uv.x - d.x * kStep, uv.y - d.y * kStep};
        return (bitmap->value({above}).g - bitmap->value({below}).g) / (2 * kStep);
      };
      const Vec2f g = bitmap->luminance_gradient(uv);
      EXPECT_NEAR(g.x, slope({1, 0}), 2e-3f) << static_cast<int>(wrap) << " at " << uv.x << ", " << uv.y;
      EXPECT_NEAR(g.y, slope({0, 1}), 2e-3f) << static_cast<int>(wrap) << " at " << uv.x << ", " << uv.y;
    }
  }
  const auto steps = make(BitmapDescription{grey_image(), TextureFilter::kNearest, TextureWrap::kRepeat, {}});
  EXPECT_EQ(steps->luminance_gradient({0.3f, 0.3f}).x, 0);
}

TEST(MeshAttribute, ShowsTheColourOfTheVertices) {
  EXPECT_EQ(make(MeshAttributeDescription{0.5f})->value({{0.3f, 0.3f}, {0.2f, 0.4f, 1}}), Rgb(0.1f, 0.2f, 0.5f));
}

TEST(Bitmap, BilinearIsTheWeightedMeanOfFourTexels) {
  const auto bitmap = make(BitmapDescription{grey_image(), TextureFilter::kBilinear, TextureWrap::kClamp, {}});
  // A quarter of a texel right of and below the centre of the first: 9/16, 3/16, 3/16 and 1/16.
  const float expected = (9 * 0.1f + 3 * 0.2f + 3 * 0.4f + 0.5f) / 16;
  EXPECT_NEAR(bitmap->value({0.75f / 3, 0.75f / 2}).g, expected, 1e-6f);
  EXPECT_NEAR(bitmap->value({0.5f / 3, 0.5f / 2}).g, 0.1f, 1e-6f) << "a texel's centre";
}

TEST(Bitmap, KeepsColoursApart) {
  const auto image = std::make_shared<const TextureImage>(2, 1, 3, std::vector<float>{0.1f, 0.2f, 0.3f, 0.6f, 0.5f, 0.4f});
  const auto bitmap = make(BitmapDescription{image, TextureFilter::kNearest, TextureWrap::kRepeat, {}});
  EXPECT_EQ(bitmap->value({0.2f, 0.5f}), Rgb(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(bitmap->value({0.7f, 0.5f}), Rgb(0.6f, 0.5f, 0.4f));
  EXPECT_NEAR(bitmap->mean_value().r, 0.35f, 1e-6f);
  EXPECT_NEAR(bitmap->mean_value().b, 0.35f, 1e-6f);
}

TEST(Bitmap, TransformsTextureCoordinatesInTheirPlane) {
  const auto at = [](const Transform& to_uv, Vec2f uv) {
    return make(BitmapDescription{grey_image(), TextureFilter::kNearest, TextureWrap::kRepeat, to_uv})->value({uv}).g;
  };
  const Transform third = Transform::translate(1.0 / 3, 0, 0);
  EXPECT_EQ(at(third, {0.1f, 0.1f}), 0.2f);
  EXPECT_EQ(at(third, {0.1f, 0.9f}), 0.5f);
  EXPECT_EQ(at(third, {0.9f, 0.1f}), 0.1f);
  EXPECT_EQ(at(Transform::scale(2, 2, 1), {0.1f, 0.4f}), 0.4f);
  EXPECT_EQ(at(Transform::scale(2, 2, 1), {0.4f, 0.1f}), 0.3f);
  EXPECT_EQ(at(Transform::rotate(0, 0, 1, 90), {0.2f, -0.9f}), 0.3f) << "(u, v) becomes (-v, u)";
}

TEST(Bitmap, AnswersAtAnyCoordinates) {
  const float huge = std::numeric_limits<float>::max(), infinity = std::numeric_limits<float>::infinity();
  for (const TextureWrap wrap : {TextureWrap::kRepeat, TextureWrap::kMirror, TextureWrap::kClamp}) {
    for (const TextureFilter filter : {TextureFilter::kNearest, TextureFilter::kBilinear}) {
      // Twice the largest number is infinite.
      const auto bitmap = make(BitmapDescription{grey_image(), filter, wrap, Transform::scale(2, 2, 1)});
      for (const float u : {-1e-9f, 1 - 6e-8f, 0.5f, 1e9f, -3e10f, huge, -huge, infinity}) {
        const float value = bitmap->value({u, -u}).g;
        EXPECT_GE(value, 0.1f) << u;
        EXPECT_LE(value, 0.6f + 1e-6f) << u;
      }
    }
  }
}

TEST(TextureImage, BytesAreDecodedFromSrgbUnlessRaw) {
  const std::vector<std::uint8_t> bytes{0, 10, 11, 128, 255, 64};
  const TextureImage srgb(2, 1, 3, bytes, true), raw(2, 1, 3, bytes, false);
  EXPECT_EQ(srgb.texel(0, 0).r, 0);
  EXPECT_NEAR(srgb.texel(0, 0).g, 10 / 255.0 / 12.92, 1e-8);  // the linear part ends below 11
  EXPECT_NEAR(srgb.texel(0, 0).b, 0.00334654, 1e-8);          // ((11 / 255 + 0.055) / 1.055)^2.4
  EXPECT_NEAR(srgb.texel(1, 0).r, 0.21586050, 1e-7);
  EXPECT_EQ(srgb.texel(1, 0).g, 1);
  EXPECT_NEAR(srgb.texel(1, 0).b, 0.05126946, 1e-7);
  EXPECT_FLOAT_EQ(raw.texel(1, 0).r, 128 / 255.0f);
}

TEST(Checkerboard, Color0LiesWhereBothHalvesAreTheSame) {
  const auto board = make(CheckerboardDescription{Rgb{0.9f}, Rgb{0.1f}, {}});
  EXPECT_EQ(board->value({0.1f, 0.1f}).r, 0.9f);
  EXPECT_EQ(board->value({0.6f, 0.1f}).r, 0.1f);
  EXPECT_EQ(board->value({0.1f, 0.6f}).r, 0.1f);
  EXPECT_EQ(board->value({0.6f, 0.6f}).r, 0.9f);
  EXPECT_EQ(board->value({0.5f, 0.5f}).r, 0.9f) << "the middle belongs to the lower half";
  EXPECT_EQ(board->value({-0.1f, 0.1f}).r, 0.1f);
  EXPECT_EQ(board->value({7.1f, -3.9f}).r, 0.9f);
  EXPECT_FLOAT_EQ(board->mean_value().r, 0.5f);
  const auto small = make(CheckerboardDescription{Rgb{0.9f}, Rgb{0.1f}, Transform::scale(2, 1, 1)});
  EXPECT_EQ(small->value({0.3f, 0.1f}).r, 0.1f);
}

}  // namespace
}  // namespace fluxfarm::testing
