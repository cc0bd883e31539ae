// libfluxfarm-images.so: OpenImageIO behind image_module.h.
#include "io/image_module.h"

#include <OpenImageIO/imageio.h>

#include <memory>
#include <stdexcept>

namespace fluxfarm {
namespace {

ImageSample sample_of(const OIIO::TypeDesc& type) {
  if (type == OIIO::TypeDesc::UINT8) return ImageSample::kUint8;
  if (type == OIIO::TypeDesc::UINT16) return ImageSample::kUint16;
  return ImageSample::kFloat;
}

class OiioFile final : public ImageFile {
 public:
  OiioFile(const char* path, const char* format) {
    OIIO::attribute("threads", 1);
    input_ = OIIO::ImageInput::create(format, false);
    if (!input_) throw std::runtime_error(OIIO::geterror());
    OIIO::ImageSpec settings, spec;
    settings.attribute("oiio:UnassociatedAlpha", 1);  // colours as they are stored
    if (!input_->open(path, spec, settings)) fail();
    header_ = {spec.width,
               spec.height,
               spec.depth,
               spec.channelnames,
               sample_of(spec.format),
               spec.deep,
               spec.get_int_attribute("Orientation", 1) != 1};
  }

  const ImageHeader& header() const override { return header_; }
  void read(int first, int count, std::uint8_t* texels) override { read(first, count, OIIO::TypeDesc::UINT8, texels); }
  void read(int first, int count, float* texels) override { read(first, count, OIIO::TypeDesc::FLOAT, texels); }

 private:
  void read(int first, int count, const OIIO::TypeDesc& type, void* texels) {
    if (!input_->read_image(0, 0, first, first + count, type, texels)) fail();
  }

  [[noreturn]] void fail() const { throw std::runtime_error(input_->geterror()); }

  std::unique_ptr<OIIO::ImageInput> input_;
  ImageHeader header_;
};

}  // namespace
}  // namespace fluxfarm

extern "C" fluxfarm::ImageFile* fluxfarm_open_image(const char* path, const char* format) {
  return new fluxfarm::OiioFile(path, format);
}
