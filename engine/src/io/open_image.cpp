#include "io/open_image.h"

#include <dlfcn.h>

#include <array>
#include <fstream>
#include <string_view>

#include "support/error.h"

namespace fluxfarm {
namespace {

OpenImageFunction load_module() {
  const std::filesystem::path module = std::filesystem::canonical("/proc/self/exe").parent_path() / kImageModule;
  void* library = dlopen(module.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw ResourceError(std::string("images cannot be read: ") + dlerror());
  void* function = dlsym(library, kOpenImageFunction);
  if (function == nullptr) throw ResourceError(module.string() + " is not the engine's own module for images");
  return reinterpret_cast<OpenImageFunction>(function);
}

// Loaded once, for the first image, and kept.
OpenImageFunction open_image_function() {
  static const OpenImageFunction function = load_module();
  return function;
}

}  // namespace

std::optional<std::string> image_format_of(const std::filesystem::path& file) {
  using namespace std::string_view_literals;
  std::array<char, 8> bytes{};
  std::ifstream(file, std::ios::binary).read(bytes.data(), bytes.size());
  const std::string_view start(bytes.data(), bytes.size());
  if (start.starts_with("\x76\x2f\x31\x01"sv)) return "openexr";
  if (start.starts_with("\x89PNG\r\n\x1a\n"sv)) return "png";
  if (start.starts_with("\xff\xd8\xff"sv)) return "jpeg";
  if (start.starts_with("#?"sv)) return "hdr";
  return std::nullopt;
}

std::unique_ptr<ImageFile> open_image(const std::filesystem::path& file, const std::string& format) {
  return std::unique_ptr<ImageFile>(open_image_function()(file.c_str(), format.c_str()));
}

}  // namespace fluxfarm
