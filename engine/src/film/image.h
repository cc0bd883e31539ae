// An image as it goes to a file: named channels of floats over a data window, and header attributes.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "film/pixel_rect.h"

namespace fluxfarm {

struct ImageChannel {
  std::string name;           // as in the EXR: "R", "albedo.R", "error.noise"
  std::vector<float> values;  // row-major over the data window
};

struct Image {
  int width = 0, height = 0;  // display window: the full frame
  PixelRect data_window;      // the pixels that the channels hold
  std::vector<ImageChannel> channels;
  std::vector<std::pair<std::string, std::variant<std::string, float, int>>> attributes;

  // The values of the channel of that name, or nullptr.
  const std::vector<float>* find(const std::string& name) const {
    for (const ImageChannel& channel : channels) {
      if (channel.name == name) return &channel.values;
    }
    return nullptr;
  }
};

}  // namespace fluxfarm
