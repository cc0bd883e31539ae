#include "io/bundle.h"

#include <algorithm>
#include <fstream>

#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

namespace fs = std::filesystem;

bool lies_inside(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

// `filename` below `base`, with every ".." and symbolic link followed; inside `folder` or an error.
fs::path find_inside(const fs::path& folder, const fs::path& base, const std::string& filename, const std::string& place) {
  if (filename.empty()) throw SceneError(place, "the name of a file is empty");
  if (filename.find('\0') != std::string::npos)
    throw SceneError(place, "file " + in_quotes(filename) + " has a zero byte in its name");
  std::error_code error;
  fs::path path = fs::weakly_canonical(base / filename, error);
  if (error) throw SceneError(place, "file " + in_quotes(filename) + " cannot be found: " + error.message());
  if (!lies_inside(path, folder)) {
    throw SceneError(place, "file " + in_quotes(filename) + " lies outside the scene's folder; copy it into the folder");
  }
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw SceneError(place, "file " + in_quotes(filename) + " does not exist in the scene's folder");
  if (!fs::is_regular_file(status)) throw SceneError(place, in_quotes(filename) + " is not a plain file");
  return path;
}

}  // namespace

Bundle::Bundle(const fs::path& folder, const fs::path& entry) {
  std::error_code error;
  folder_ = fs::canonical(folder, error);
  if (error || !fs::is_directory(folder_)) {
    throw SceneError(folder.string(), "is not a folder, expected the folder that holds the scene");
  }
  entry_ = find_inside(folder_, folder_, entry.string(), "scene");
}

fs::path Bundle::find(const std::string& filename, const std::string& place) const {
  return find_inside(folder_, entry_.parent_path(), filename, place);
}

fs::path Bundle::find_beside(const fs::path& from, const std::string& filename, const std::string& place) const {
  return find_inside(folder_, from.parent_path(), filename, place);
}

std::string Bundle::name(const fs::path& file) const { return file.lexically_relative(folder_).generic_string(); }

std::string read_file(const fs::path& file, const std::string& name, std::uintmax_t max_bytes) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  if (error) throw ResourceError(name + ": cannot be read: " + error.message());
  if (size > max_bytes) {
    throw SceneError(name, "has " + std::to_string(size) + " bytes, expected at most " + std::to_string(max_bytes));
  }
  std::string bytes(size, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  if (!stream || static_cast<std::uintmax_t>(stream.gcount()) != size) throw ResourceError(name + ": cannot be read");
  return bytes;
}

}  // namespace fluxfarm
