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

  Rgb value(Vec2f uv) const override {
    const Vec2f p = to_uv_(uv);
    const float x = inside(p.x) * static_cast<float>(image_->width());
    const float y = inside(p.y) * static_cast<float>(image_->height());
    if (filter_ == TextureFilter::kNearest) return image_->texel(column(std::floor(x)), row(std::floor(y)));
    const float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f);
    const float s = x - 0.5f - left, t = y - 0.5f - top;
    const int x0 = column(left), x1 = column(left + 1), y0 = row(top), y1 = row(top + 1);
    const Rgb upper = image_->texel(x0, y0) * (1 - s) + image_->texel(x1, y0) * s;
    const Rgb lower = image_->texel(x0, y1) * (1 - s) + image_->texel(x1, y1) * s;
    return upper * (1 - t) + lower * t;
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
