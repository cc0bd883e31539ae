#include "worker/merge.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <span>

#include "io/exr.h"
#include "io/png.h"
#include "support/parallel.h"
#include "worker/build_id.h"
#include "worker/tile_file.h"

namespace fluxfarm {
namespace {

// A larger film (264 bytes a pixel and 24 for each light layer) is read again rather than kept.
constexpr std::int64_t kMostKeptPixels = 1 << 20;

ImageInfo with_build(ImageInfo info) {
  info.engine_build = engine_build_id();
  return info;
}

void merge_tiles(Film& film, std::span<const std::filesystem::path> tiles) {
  for (const std::filesystem::path& path : tiles) film.merge(read_tile_file(path));
}

// The film that the request's tiles are merged into. A new one takes its light layers and bias from the first tile.
template <typename Request>
Film first_film(const Request& request, PixelRect crop) {
  if (!request.film_in.empty()) return Film::load(request.film_in);
  if (request.tiles.empty()) return Film(request.width, request.height, crop);
  const TileSums first = read_tile_file(request.tiles.front());
  return Film(request.width, request.height, crop, first.layers, first.biased);
}

}  // namespace

std::optional<PassMerger::KeptFilm> PassMerger::take(const MergePassRequest& request) {
  const std::lock_guard lock(mutex_);
  // Tile files are named by job and content, so equal paths are equal tiles.
  if (!kept_ || kept_->film_in != request.film_in || kept_->tiles.size() > request.tiles.size() ||
      !std::equal(kept_->tiles.begin(), kept_->tiles.end(), request.tiles.begin())) {
    return std::nullopt;
  }
  std::optional<KeptFilm> kept = std::move(kept_);
  kept_.reset();
  return kept;
}

void PassMerger::forget() {
  const std::lock_guard lock(mutex_);
  kept_.reset();
}

PassMergedReply PassMerger::merge(const MergePassRequest& request, const LightAudit* audit, bool bias_falls) {
  const auto begin = std::chrono::steady_clock::now();
  std::optional<KeptFilm> kept = take(request);
  const std::size_t merged = kept ? kept->tiles.size() : 0;
  Film film = kept ? std::move(kept->film) : first_film(request, request.crop);
  merge_tiles(film, std::span(request.tiles).subspan(merged));

  const Image image = film.image(film.crop(), with_build(request.info));
  PassMergedReply reply;
  const std::array<std::function<void()>, 5> outputs = {
      [&] {
        if (!request.exr_out.empty()) write_exr(request.exr_out, image);
      },
      [&] {
        if (!request.film_out.empty()) film.save(request.film_out);
      },
      [&] {
        if (!request.png_out.empty()) write_png(request.png_out, image);
      },
      [&] { reply.summary = film.summary(); },
      [&] {
        if (request.decision) reply.look = look_at(film, request.decision->goal, request.decision->round, audit, bias_falls);
      },
  };
  // At the end of a job nothing else is left to do, and its owner waits.
  parallel_for(outputs.size(), 2, [&](std::size_t index, int) { outputs[index](); });

  // The request after a film file begins with that file, under a name that is not known here.
  if (request.film_out.empty() && request.crop.pixels() <= kMostKeptPixels) {
    const std::lock_guard lock(mutex_);
    kept_ = KeptFilm{request.film_in, request.tiles, std::move(film)};
  }
  reply.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return reply;
}

void write_tile(const WriteTileRequest& request) {
  Film film = first_film(request, request.rect);
  merge_tiles(film, request.tiles);
  write_exr(request.exr_out, film.image(request.rect, with_build(request.info)));
}

}  // namespace fluxfarm
