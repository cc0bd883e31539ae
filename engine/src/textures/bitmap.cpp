// An image over the unit square of uv, repeated, mirrored or continued outside; as Mitsuba's `bitmap`. Texel centres lie at
// ((x + 1/2) / width, (y + 1/2) / height), v = 0 at the top.
#include "support/check.h"
#include "textures/texture_factories.h"
#include "textures/uv_map.h"

namespace fluxfarm {
namespace {

class Bitmap final : public Texture {
 public:
  explicit Bitmap(const BitmapDescription& d) : image_(d.image), filter_(d.filter), wrap_(d.wrap), to_uv_(d.to_uv) {
    FLUXFARM_CHECK(image_ != nullptr, "a texture in use has its image");
  }

  Rgb value(const TexturePoint& point) const override {
    const Vec2f p = to_uv_(point.uv);
    const float x = inside(p.x) * static_cast<float>(image_->width());
    const float y = inside(p.y) * static_cast<float>(image_->height());
    if (filter_ == TextureFilter::kNearest) return image_->texel(column(std::floor(x)), row(std::floor(y)));
    const Corners c = corners(x, y);
    const Rgb upper = c.texel[0] * (1 - c.s) + c.texel[1] * c.s;
    const Rgb lower = c.texel[2] * (1 - c.s) + c.texel[3] * c.s;
    return upper * (1 - c.t) + lower * c.t;
  }

  // Of the bilinear surface: constant across a texel's row, with steps at the centres. Mirrored squares run backwards.
  Vec2f luminance_gradient(Vec2f uv) const override {
    if (filter_ == TextureFilter::kNearest) return {};
    const Vec2f p = to_uv_(uv);
    const float width = static_cast<float>(image_->width()), height = static_cast<float>(image_->height());
    const Corners c = corners(inside(p.x) * width, inside(p.y) * height);
    const float y00 = luminance(c.texel[0]), y10 = luminance(c.texel[1]), y01 = luminance(c.texel[2]), y11 = luminance(c.texel[3]);
    const float by_x = ((y10 - y00) * (1 - c.t) + (y11 - y01) * c.t) * width * sense(p.x);
    const float by_y = ((y01 - y00) * (1 - c.s) + (y11 - y10) * c.s) * height * sense(p.y);
    return to_uv_.gradient({by_x, by_y});
  }

  Rgb mean_value() const override {
    double r = 0, g = 0, b = 0;
    for (int y = 0; y < image_->height(); ++y) {
      for (int x = 0; x < image_->width(); ++x) {
        const Rgb texel = image_->texel(x, y);
        r += static_cast<double>(texel.r);
        g += static_cast<double>(texel.g);
        b += static_cast<double>(texel.b);
      }
    }
    const double n = static_cast<double>(image_->width()) * image_->height();
    return {static_cast<float>(r / n), static_cast<float>(g / n), static_cast<float>(b / n)};
  }

 private:
  // The texels around a place of the image, in texels from its corner: upper left and right, lower left and right; s and t from the
  // first.
  struct Corners {
    Rgb texel[4];
    float s, t;
  };
  Corners corners(float x, float y) const {
    const float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f);
    const int x0 = column(left), x1 = column(left + 1), y0 = row(top), y1 = row(top + 1);
    return {{image_->texel(x0, y0), image_->texel(x1, y0), image_->texel(x0, y1), image_->texel(x1, y1)},
            x - 0.5f - left,
            y - 0.5f - top};
  }

  // -1 where the image is shown mirrored, 0 where it is continued outside, else 1.
  float sense(float u) const {
    switch (wrap_) {
      case TextureWrap::kRepeat: return 1;
      case TextureWrap::kMirror: return fraction(0.5f * u) > 0.5f ? -1.0f : 1.0f;
      case TextureWrap::kClamp: return u > 0 && u < 1 ? 1.0f : 0.0f;
    }
    return 1;
  }

  // The coordinate of the image that stands at u, in [0,1].
  float inside(float u) const {
    switch (wrap_) {
      case TextureWrap::kRepeat: return fraction(u);
      case TextureWrap::kMirror: {
        const float t = 2 * fraction(0.5f * u);
        return t > 1 ? 2 - t : t;
      }
      case TextureWrap::kClamp: return u > 0 ? std::min(u, 1.0f) : 0.0f;
    }
    return 0;
  }

  // A column or row from -1 to the size: one step outside is the opposite edge where the image repeats, else the same edge.
  int column(float x) const { return on_image(static_cast<int>(x), image_->width()); }
  int row(float y) const { return on_image(static_cast<int>(y), image_->height()); }
  int on_image(int i, int size) const {
    if (i >= 0 && i < size) return i;
    return (i < 0) == (wrap_ == TextureWrap::kRepeat) ? size - 1 : 0;
  }

  std::shared_ptr<const TextureImage> image_;
  TextureFilter filter_;
  TextureWrap wrap_;
  UvMap to_uv_;
};

}  // namespace

std::unique_ptr<Texture> make_bitmap(const BitmapDescription& d) { return std::make_unique<Bitmap>(d); }

}  // namespace fluxfarm
