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

template <typename T>
std::vector<T> decode(ImageFile& file, Channels channels) {
  const ImageHeader& header = file.header();
  std::vector<T> texels(static_cast<std::size_t>(header.width * header.height) * static_cast<std::size_t>(channels.count));
  file.read(channels.first, channels.count, texels.data());
  return texels;
}

// `srgb`: integers are encoded so.
TextureImage to_image(std::vector<std::uint8_t> texels, int channels, const ImageHeader& header, const std::string&, bool srgb) {
  return {static_cast<int>(header.width), static_cast<int>(header.height), channels, std::move(texels), srgb};
}

TextureImage to_image(std::vector<float> texels, int channels, const ImageHeader& header, const std::string& name, bool srgb) {
  check_reflectances(texels, static_cast<std::size_t>(header.width), static_cast<std::size_t>(channels), name);
  if (header.sample == ImageSample::kUint16 && srgb) std::transform(texels.begin(), texels.end(), texels.begin(), srgb_to_linear);
  return {static_cast<int>(header.width), static_cast<int>(header.height), channels, std::move(texels)};
}

template <typename T>
TextureImage read(ImageFile& file, Channels channels, const std::string& name, bool srgb) {
  return to_image(decode<T>(file, channels), channels.count, file.header(), name, srgb);
}

// Alpha stands behind the colours.
template <typename T>
ImageAndAlpha read_both(ImageFile& file, Channels colors, const std::string& name) {
  const std::vector<T> both = decode<T>(file, {colors.first, colors.count + 1});
  const auto count = static_cast<std::size_t>(colors.count);
  std::vector<T> color_texels, alpha_texels;
  color_texels.reserve(both.size() / (count + 1) * count);
  alpha_texels.reserve(both.size() / (count + 1));
  for (auto texel = both.begin(); texel != both.end(); texel += colors.count + 1) {
    color_texels.insert(color_texels.end(), texel, texel + colors.count);
    alpha_texels.push_back(texel[colors.count]);
  }
  return {to_image(std::move(color_texels), colors.count, file.header(), name, true),
          to_image(std::move(alpha_texels), 1, file.header(), name, false)};
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
  return with_image(file, name, [&](ImageFile& image) {
    const Channels channels = channels_of(image.header(), name);
    const bool bytes = image.header().sample == ImageSample::kUint8;
    return bytes ? read<std::uint8_t>(image, channels, name, !raw) : read<float>(image, channels, name, !raw);
  });
}

ImageAndAlpha read_image_and_alpha(const std::filesystem::path& file, const std::string& name) {
  return with_image(file, name, [&](ImageFile& image) -> ImageAndAlpha {
    const Channels colors = channels_of(image.header(), name);
    const std::vector<std::string>& names = image.header().channels;
    const bool bytes = image.header().sample == ImageSample::kUint8;
    const std::size_t behind = static_cast<std::size_t>(colors.first) + static_cast<std::size_t>(colors.count);
    if (behind < names.size() && names[behind] == "A")
      return bytes ? read_both<std::uint8_t>(image, colors, name) : read_both<float>(image, colors, name);
    return {bytes ? read<std::uint8_t>(image, colors, name, true) : read<float>(image, colors, name, true), std::nullopt};
  });
}

}  // namespace fluxfarm
