#include "output_file.h"

#include <fstream>
#include <system_error>
#include <utility>

#include "support/error.h"

namespace fluxfarm {

OutputFile::OutputFile(std::filesystem::path path) : path_(std::move(path)), part_(path_) {
  part_ += ".part";
  std::error_code error;
  if (std::filesystem::is_directory(path_, error)) throw SettingError(path_.string() + ": is a folder, expected a file to write");
  if (!std::ofstream(part_))
    throw SettingError(path_.string() + ": cannot be written; does its folder exist, and may you write there?");
}

OutputFile::~OutputFile() {
  std::error_code error;
  std::filesystem::remove(part_, error);  // nothing to do about a file that stays
}

void OutputFile::commit(const std::function<void(const std::filesystem::path&)>& write) {
  write(part_);
  std::error_code error;
  std::filesystem::rename(part_, path_, error);
  if (error) throw ResourceError(path_.string() + ": cannot be written: " + error.message());
}

}  // namespace fluxfarm
