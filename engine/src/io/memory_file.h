// Bytes in memory that the decoders of images can open by a path, as they open files (Linux).
#pragma once

#include <filesystem>
#include <string_view>

namespace fluxfarm {

class MemoryFile {
 public:
  // Throws ResourceError if the system gives no such file.
  explicit MemoryFile(std::string_view bytes);
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  // Valid in this process while this lives.
  std::filesystem::path path() const;

 private:
  int descriptor_;
};

}  // namespace fluxfarm
