#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>

#include <mutex>

#include "io/exr.h"
#include "support/check.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

// Compression takes most of the time, and a finished job waits for nothing else.
constexpr int kThreads = 2;

Imf::Header make_header(const Image& image) {
  const PixelRect& rect = image.data_window;
  const Imath::Box2i display({0, 0}, {image.width - 1, image.height - 1});
  const Imath::Box2i data({rect.x, rect.y}, {rect.x + rect.width - 1, rect.y + rect.height - 1});
  Imf::Header header(display, data, 1, {0, 0}, 1, Imf::INCREASING_Y, Imf::ZIP_COMPRESSION);
  for (const auto& [name, value] : image.attributes) {
    if (const auto* text = std::get_if<std::string>(&value)) {
      header.insert(name, Imf::StringAttribute(*text));
    } else if (const auto* number = std::get_if<float>(&value)) {
      header.insert(name, Imf::FloatAttribute(*number));
    } else {
      header.insert(name, Imf::IntAttribute(std::get<int>(value)));
    }
  }
  for (const ImageChannel& channel : image.channels) header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
  return header;
}

Imf::FrameBuffer make_frame_buffer(const Image& image) {
  const PixelRect& rect = image.data_window;
  Imf::FrameBuffer buffer;
  for (const ImageChannel& channel : image.channels) {
    // The slice's base is where pixel (0, 0) of the frame would lie. OpenEXR wants a char*; writing does not change the values.
    buffer.insert(channel.name,
                  Imf::Slice::Make(Imf::FLOAT, channel.values.data(), Imath::V2i(rect.x, rect.y), rect.width, rect.height));
  }
  return buffer;
}

}  // namespace

void write_exr(const std::filesystem::path& path, const Image& image) {
  FLUXFARM_CHECK(!image.data_window.empty() && image.width > 0 && image.height > 0, "an EXR needs pixels");
  for (const ImageChannel& channel : image.channels) {
    FLUXFARM_CHECK(channel.values.size() == static_cast<std::size_t>(image.data_window.pixels()),
                   "a channel covers the data window");
  }
  try {
    static std::once_flag once;
    std::call_once(once, [] { Imf::setGlobalThreadCount(kThreads); });
    Imf::OutputFile file(path.c_str(), make_header(image), kThreads);
    file.setFrameBuffer(make_frame_buffer(image));
    file.writePixels(image.data_window.height);
  } catch (const std::exception& error) {
    throw ResourceError(path.string() + ": cannot be written as EXR: " + error.what());
  }
}

}  // namespace fluxfarm
