#include "worker/merge.h"

#include <fstream>
#include <iterator>

#include "io/exr.h"
#include "io/png.h"
#include "support/error.h"
#include "worker/build_id.h"
#include "worker/codec.h"

namespace fluxfarm {
namespace {

TileSums read_tile(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw ResourceError(path.string() + ": cannot read the tile");
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  return decode_tile_sums(bytes, path.string());
}

ImageInfo with_build(ImageInfo info) {
  info.engine_build = engine_build_id();
  return info;
}

template <typename Request>
Film merged_film(const Request& request, PixelRect crop) {
  Film film = request.film_in.empty() ? Film(request.width, request.height, crop) : Film::load(request.film_in);
  for (const std::filesystem::path& path : request.tiles) film.merge(read_tile(path));
  return film;
}

}  // namespace

FilmSummary merge_pass(const MergePassRequest& request) {
  const Film film = merged_film(request, request.crop);
  if (!request.film_out.empty()) film.save(request.film_out);
  const Image image = film.image(film.crop(), with_build(request.info));
  if (!request.exr_out.empty()) write_exr(request.exr_out, image);
  if (!request.png_out.empty()) write_png(request.png_out, image);
  return film.summary();
}

void write_tile(const WriteTileRequest& request) {
  const Film film = merged_film(request, request.rect);
  write_exr(request.exr_out, film.image(request.rect, with_build(request.info)));
}

}  // namespace fluxfarm
