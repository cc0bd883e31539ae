#include "io/read_image.h"

#include <algorithm>
#include <memory>
#include <optional>

#include "io/jpeg_size.h"
#include "io/limits.h"
#include "io/open_image.h"
#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

void check_size(std::int64_t width, std::int64_t height, const std::string& name) {
  if (width >= 1 && height >= 1 && width <= kMaxImageSide && height <= kMaxImageSide && width * height <= kMaxImagePixels) return;
  throw SceneError(name, "the image has " + std::to_string(width) + " x " + std::to_string(height) +
                             " pixels, expected sides of 1 to " + std::to_string(kMaxImageSide) + " and at most " +
                             std::to_string(kMaxImagePixels) + " pixels");
}

struct Channels {
  int first = 0, count = 1;
};

// R, G and B where they stand together; the only channel, or the one beside alpha, as grey.
Channels channels_of(const ImageHeader& header, const std::string& name) {
  const std::vector<std::string>& names = header.channels;
  const auto red = std::find(names.begin(), names.end(), "R");
  if (names.end() - red >= 3 && red[1] == "G" && red[2] == "B") return {static_cast<int>(red - names.begin()), 3};
  if (names.size() == 1 || (names.size() == 2 && names[1] == "A")) return {0, 1};
  throw SceneError(name, names.empty()
                             ? std::string("the image has no channels, expected R, G and B, or one")
                             : "the image has the channels " + in_quotes(joined(names)) + ", expected R, G and B, or one");
}

void check_header(const ImageHeader& header, const std::string& name) {
  if (header.deep) throw SceneError(name, "is a deep image, expected one value a pixel");
  if (header.depth > 1)
    throw SceneError(name, "the image is " + std::to_string(header.depth) + " pixels deep, expected a flat one");
  check_size(header.width, header.height, name);
}

void check_reflectances(const std::vector<float>& values, std::size_t width, std::size_t channels, const std::string& name) {
  const auto wrong = std::find_if(values.begin(), values.end(), [](float v) { return !(v >= 0 && v <= 1); });
  if (wrong == values.end()) return;
  const std::size_t texel = static_cast<std::size_t>(wrong - values.begin()) / channels;
  throw SceneError(name, "pixel (" + std::to_string(texel % width) + ", " + std::to_string(texel / width) + ") has the value " +
                             number_text(static_cast<double>(*wrong)) + ", expected numbers in [0, 1]: a reflectance");
}

// These channels of the image. `srgb`: integers are encoded so.
TextureImage read(ImageFile& file, Channels channels, const std::string& name, bool srgb) {
  const ImageHeader& header = file.header();
  const int width = static_cast<int>(header.width), height = static_cast<int>(header.height);
  const std::size_t values = static_cast<std::size_t>(header.width * header.height) * static_cast<std::size_t>(channels.count);
  if (header.sample == ImageSample::kUint8) {
    std::vector<std::uint8_t> texels(values);
    file.read(channels.first, channels.count, texels.data());
    return {width, height, channels.count, std::move(texels), srgb};
  }
  std::vector<float> texels(values);
  file.read(channels.first, channels.count, texels.data());
  check_reflectances(texels, static_cast<std::size_t>(width), static_cast<std::size_t>(channels.count), name);
  if (header.sample == ImageSample::kUint16 && srgb) std::transform(texels.begin(), texels.end(), texels.begin(), srgb_to_linear);
  return {width, height, channels.count, std::move(texels)};
}

// What `use` makes of the image in the file, whose size was checked.
template <typename Use>
auto with_image(const std::filesystem::path& file, const std::string& name, const Use& use) {
  const std::optional<std::string> format = image_format_of(file);
  if (!format) throw SceneError(name, "is no image that can be read, expected EXR, HDR, PNG or JPEG");
  // Its decoder takes memory for the whole image before it tells the size.
  if (*format == "jpeg") {
    const auto [width, height] = jpeg_size(file);
    check_size(width, height, name);
  }
  try {
    const std::unique_ptr<ImageFile> image = open_image(file, *format);
    check_header(image->header(), name);
    return use(*image);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw ResourceError(name + ": not enough memory for the image");
  } catch (const std::exception& error) {
    throw SceneError(name, "is a damaged " + *format + " image: " + printable(error.what()));
  }
}

}  // namespace

TextureImage read_image(const std::filesystem::path& file, const std::string& name, bool raw) {
  return with_image(file, name, [&](ImageFile& image) { return read(image, channels_of(image.header(), name), name, !raw); });
}

std::optional<TextureImage> read_alpha(const std::filesystem::path& file, const std::string& name) {
  return with_image(file, name, [&](ImageFile& image) -> std::optional<TextureImage> {
    const std::vector<std::string>& names = image.header().channels;
    const auto alpha = std::find(names.begin(), names.end(), "A");
    if (alpha == names.end()) return std::nullopt;
    return read(image, {static_cast<int>(alpha - names.begin()), 1}, name, false);
  });
}

}  // namespace fluxfarm
