// The folder of a scene: finds the files that the scene names and opens nothing outside that folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace fluxfarm {

class Bundle {
 public:
  // `entry` is the scene file, relative to `folder`. Throws SceneError if it is missing or lies outside.
  Bundle(const std::filesystem::path& folder, const std::filesystem::path& entry);

  // The file that the scene calls `filename` at `place` ("scene.xml:12"), relative to the folder of the entry file. Throws
  // SceneError if it does not exist, is not a plain file, or leaves the folder, by "..", an absolute path or a symbolic link.
  std::filesystem::path find(const std::string& filename, const std::string& place) const;

  // The same for what the found file `from` calls `filename`, relative to that file's folder.
  std::filesystem::path find_beside(const std::filesystem::path& from, const std::string& filename, const std::string& place) const;

  // Path of a found file as messages show it: relative to the folder.
  std::string name(const std::filesystem::path& file) const;

  const std::filesystem::path& entry() const { return entry_; }

 private:
  std::filesystem::path folder_;  // canonical
  std::filesystem::path entry_;   // canonical, inside folder_
};

// The bytes of a file found by a Bundle. Throws SceneError naming `name` if it is larger than `max_bytes`, ResourceError if
// it cannot be read.
std::string read_file(const std::filesystem::path& file, const std::string& name, std::uintmax_t max_bytes);

}  // namespace fluxfarm
