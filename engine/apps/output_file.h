// A file that appears whole or not at all, and whose folder is tried before the work begins rather than after.
#pragma once

#include <filesystem>
#include <functional>

namespace fluxfarm {

class OutputFile {
 public:
  // Creates "PATH.part". Throws SettingError at once when that cannot be done.
  explicit OutputFile(std::filesystem::path path);
  // Removes the part file unless it was committed.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // Lets `write` fill the part file, then gives it its name. Throws ResourceError when the file cannot be renamed.
  void commit(const std::function<void(const std::filesystem::path&)>& write);

 private:
  std::filesystem::path path_, part_;
};

}  // namespace fluxfarm
