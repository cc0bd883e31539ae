#include "read_as.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "io/scene_reader.h"
#include "support/error.h"

namespace fluxfarm::fuzz {
namespace {

// In memory where the machine has such a folder; removed at the end, but not after a finding.
class Folder {
 public:
  Folder() { std::filesystem::create_directories(path_); }
  ~Folder() { std::filesystem::remove_all(path_); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_ =
      (std::filesystem::exists("/dev/shm") ? std::filesystem::path("/dev/shm") : std::filesystem::temp_directory_path()) /
      ("fluxfarm-fuzz-" + std::to_string(getpid()));
};

}  // namespace

void read_as(const char* name, const std::uint8_t* data, std::size_t size) {
  static const Folder folder;
  std::ofstream(folder.path() / name, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    read_scene(folder.path(), name);
  } catch (const SceneError&) {
  } catch (const ResourceError&) {
  }
}

}  // namespace fluxfarm::fuzz
