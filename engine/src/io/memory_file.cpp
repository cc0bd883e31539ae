#include "io/memory_file.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "support/error.h"

namespace fluxfarm {

MemoryFile::MemoryFile(std::string_view bytes) : descriptor_(memfd_create("fluxfarm-image", MFD_CLOEXEC)) {
  const auto fail = [](const char* what) { throw ResourceError(std::string(what) + ": " + std::strerror(errno)); };
  if (descriptor_ < 0) fail("no file in memory can be made for an image");
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      ::close(descriptor_);
      fail("an image cannot be put into memory");
    }
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

MemoryFile::~MemoryFile() { ::close(descriptor_); }

std::filesystem::path MemoryFile::path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

}  // namespace fluxfarm
