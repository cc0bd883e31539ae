#include "io/read_film.h"

#include "io/limits.h"
#include "io/properties.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

constexpr NumberRange kSide{1, static_cast<double>(kMaxImageSide)};

PixelFilterDescription gaussian(float stddev) { return {PixelFilterKind::kGaussian, 4 * stddev, stddev}; }

PixelFilterDescription read_filter(const PluginNode& filter) {
  check_no_children(filter);
  Properties properties(filter);
  PixelFilterDescription result;
  if (filter.type == "box") {
    result = {PixelFilterKind::kBox, 0.5f, 0.5f};
  } else if (filter.type == "tent") {
    result = {PixelFilterKind::kTent, properties.number("radius", 1, {0, 64, true}), 0.5f};
  } else {
    result = gaussian(properties.number("stddev", 0.5f, {0, 16, true}));
  }
  properties.finish();
  return result;
}

// Offset and length of the crop window along one axis; {0, 0} for the full side.
std::pair<int, int> read_crop(Properties& properties, const std::string& offset_name, const std::string& size_name, int side) {
  const int offset = static_cast<int>(properties.integer(offset_name, 0, {0, static_cast<double>(side - 1)}));
  const int size = static_cast<int>(properties.integer(size_name, side, {1, static_cast<double>(side)}));
  if (offset + size > side) {
    properties.fail(
        properties.has(size_name) ? size_name : offset_name,
        "the crop window ends at pixel " + std::to_string(offset + size) + ", expected at most " + std::to_string(side));
  }
  return {offset, size};
}

}  // namespace

FilmDescription default_film() {
  FilmDescription film;
  film.filter = gaussian(0.5f);
  return film;
}

FilmDescription read_film(const PluginNode& node) {
  Properties properties(node);
  FilmDescription film = default_film();
  film.width = static_cast<int>(properties.integer("width", film.width, kSide));
  film.height = static_cast<int>(properties.integer("height", film.height, kSide));
  if (std::int64_t{film.width} * film.height > kMaxImagePixels) {
    properties.fail("width", "height = " + std::to_string(film.height) + ": " +
                                 std::to_string(std::int64_t{film.width} * film.height) + " pixels, expected at most " +
                                 std::to_string(kMaxImagePixels));
  }
  const auto [x, width] = read_crop(properties, "crop_offset_x", "crop_width", film.width);
  const auto [y, height] = read_crop(properties, "crop_offset_y", "crop_height", film.height);
  if (width != film.width || height != film.height) {
    film.crop_x = x;
    film.crop_y = y;
    film.crop_width = width;
    film.crop_height = height;
  }
  properties.ignore(
      {"file_format", "pixel_format", "component_format", "banner", "sample_border", "high_quality_edges", "compensate"});
  properties.finish();

  bool has_filter = false;
  for (const PluginNode& child : node.children) {
    if (child.kind != PluginKind::kFilter || has_filter) fail_nested(node, child, "one rfilter");
    film.filter = read_filter(child);
    has_filter = true;
  }
  return film;
}

}  // namespace fluxfarm
