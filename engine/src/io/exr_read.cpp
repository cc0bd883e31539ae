#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfStringAttribute.h>

#include "io/exr.h"
#include "io/limits.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

bool is_own(const std::string& name) { return name == "pixelAspectRatio" || name == "screenWindowWidth"; }

void read_attributes(const Imf::Header& header, Image& image) {
  for (auto it = header.begin(); it != header.end(); ++it) {
    const std::string name = it.name();
    if (is_own(name)) continue;
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&it.attribute()))
      image.attributes.emplace_back(name, text->value());
    if (const auto* number = dynamic_cast<const Imf::FloatAttribute*>(&it.attribute()))
      image.attributes.emplace_back(name, number->value());
    if (const auto* integer = dynamic_cast<const Imf::IntAttribute*>(&it.attribute()))
      image.attributes.emplace_back(name, integer->value());
  }
}

// The sides come from the file and are not trusted: they are checked before memory is taken.
void read_windows(const Imf::Header& header, Image& image) {
  const Imath::Box2i &data = header.dataWindow(), &display = header.displayWindow();
  const auto side = [](int first, int last) { return std::int64_t{last} - first + 1; };
  const std::int64_t width = side(data.min.x, data.max.x), height = side(data.min.y, data.max.y);
  if (width < 1 || height < 1 || width > kMaxImageSide || height > kMaxImageSide || width * height > kMaxImagePixels) {
    throw std::runtime_error("the data window is " + std::to_string(width) + " x " + std::to_string(height));
  }
  image.data_window = {data.min.x, data.min.y, static_cast<int>(width), static_cast<int>(height)};
  image.width = static_cast<int>(std::min(side(display.min.x, display.max.x), kMaxImageSide));
  image.height = static_cast<int>(std::min(side(display.min.y, display.max.y), kMaxImageSide));
}

// Without `wanted`, all channels.
Image read(const std::filesystem::path& path, const std::set<std::string>* wanted) {
  Imf::InputFile file(path.c_str(), 0);
  Image image;
  read_windows(file.header(), image);
  read_attributes(file.header(), image);
  for (auto it = file.header().channels().begin(); it != file.header().channels().end(); ++it) {
    if (wanted && !wanted->count(it.name())) continue;
    image.channels.push_back({it.name(), std::vector<float>(static_cast<std::size_t>(image.data_window.pixels()))});
  }
  const PixelRect& rect = image.data_window;
  Imf::FrameBuffer buffer;
  for (ImageChannel& channel : image.channels) {
    buffer.insert(channel.name,
                  Imf::Slice::Make(Imf::FLOAT, channel.values.data(), Imath::V2i(rect.x, rect.y), rect.width, rect.height));
  }
  file.setFrameBuffer(buffer);
  file.readPixels(rect.y, rect.y + rect.height - 1);
  return image;
}

Image read_or_fail(const std::filesystem::path& path, const std::set<std::string>* wanted) {
  try {
    return read(path, wanted);
  } catch (const std::exception& error) {
    throw ResourceError(path.string() + ": cannot be read as EXR: " + error.what());
  }
}

}  // namespace

Image read_exr(const std::filesystem::path& path) { return read_or_fail(path, nullptr); }

Image read_exr(const std::filesystem::path& path, const std::set<std::string>& wanted) { return read_or_fail(path, &wanted); }

}  // namespace fluxfarm
