// Options that name a scene and change it, shared by the commands.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "scene/description.h"

namespace fluxfarm {

struct SceneOptions {
  std::filesystem::path scene;
  std::string size;                  // "WxH" or empty
  std::string crop;                  // "x,y,w,h" or empty
  std::vector<std::string> defines;  // "name=value"

  void add_to(CLI::App& command, bool with_crop);

  // Reads the scene and applies size and crop: the description's crop is then never empty.
  // Throws SceneError or SettingError.
  SceneDescription read() const;
};

// Number of render threads: `threads` if positive, else all cores.
int resolve_threads(int threads);

}  // namespace fluxfarm
