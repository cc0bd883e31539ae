#include "scene_options.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <thread>

#include "io/scene_reader.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

constexpr int kMaxSide = 65536;
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 27;

// Exactly N integers with `separator` between them.
template <std::size_t N>
std::array<int, N> parse_integers(const std::string& text, char separator, const std::string& option, const std::string& expected) {
  std::array<int, N> values{};
  const char* position = text.data();
  const char* const end = text.data() + text.size();
  for (std::size_t i = 0; i < N; ++i) {
    const auto [rest, error] = std::from_chars(position, end, values[i]);
    const bool last = i + 1 == N;
    if (error != std::errc{} || (last ? rest != end : rest == end || *rest != separator)) {
      throw SettingError(option + " = \"" + text + "\", expected " + expected);
    }
    position = rest + 1;
  }
  return values;
}

}  // namespace

void SceneOptions::add_to(CLI::App& command, bool with_crop) {
  command.add_option("SCENE", scene, "Scene file: Mitsuba 3 XML (.xml), its JSON form (.json) or glTF 2.0 (.glb, .gltf)")
      ->required();
  command.add_option("--size", size, "Film size WxH in pixels; default: as the scene says");
  if (with_crop) command.add_option("--crop", crop, "Part of the frame x,y,w,h in pixels");
  command.add_option("-D", defines, "Value of a <default> of the scene: name=value");
}

SceneDescription SceneOptions::read() const {
  SceneOverrides overrides;
  for (const std::string& define : defines) {
    const std::size_t equals = define.find('=');
    if (equals == 0 || equals == std::string::npos) throw SettingError("-D " + define + ", expected name=value");
    overrides[define.substr(0, equals)] = define.substr(equals + 1);
  }
  const std::filesystem::path folder = scene.has_parent_path() ? scene.parent_path() : ".";
  SceneDescription description = read_scene(folder, scene.filename(), overrides);
  FilmDescription& film = description.film;
  if (!size.empty()) {
    const auto [width, height] = parse_integers<2>(size, 'x', "--size", "WxH, for example 640x480");
    if (width < 1 || height < 1 || std::max(width, height) > kMaxSide || std::int64_t{width} * height > kMaxPixels) {
      throw SettingError("--size = " + size + ", expected sides from 1 to 65536 and at most 2^27 pixels");
    }
    if (width != film.width || height != film.height) film = {width, height, 0, 0, 0, 0, film.filter};
  }
  if (!crop.empty()) {
    const auto [x, y, w, h] = parse_integers<4>(crop, ',', "--crop", "x,y,w,h in pixels");
    if (x < 0 || y < 0 || w < 1 || h < 1 || x > film.width - w || y > film.height - h) {
      throw SettingError("--crop = " + crop + ", expected a part of the " + std::to_string(film.width) + "x" +
                         std::to_string(film.height) + " frame");
    }
    film = {film.width, film.height, x, y, w, h, film.filter};
  }
  if (film.crop_width == 0) film = {film.width, film.height, 0, 0, film.width, film.height, film.filter};
  return description;
}

int resolve_threads(int threads) {
  if (threads > 0) return threads;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace fluxfarm
