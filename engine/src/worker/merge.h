// Carries out MergePass and WriteTile: from film and tile files to films and images.
#pragma once

#include <mutex>
#include <optional>

#include "worker/messages.h"

namespace fluxfarm {

// Merges passes. Keeps the film of the last merge in memory, if it wrote no film file, so that a request which goes on from there
// costs its new tiles only; the bits are those of merging everything. Threads may merge at the same time.
class PassMerger {
 public:
  // Throws ResourceError when a file cannot be read or written, Error when tiles do not follow the film.
  // A decision hears the `audit` of the scene, if there is one.
  PassMergedReply merge(const MergePassRequest& request, const LightAudit* audit = nullptr, bool bias_falls = true);
  // Gives back the memory of the kept film.
  void forget();

 private:
  struct KeptFilm {
    std::filesystem::path film_in;
    std::vector<std::filesystem::path> tiles;
    Film film;
  };
  // The film kept for the requests before this one of the same job, or nothing.
  std::optional<KeptFilm> take(const MergePassRequest& request);

  std::mutex mutex_;
  std::optional<KeptFilm> kept_;
};

// Throws as PassMerger::merge.
void write_tile(const WriteTileRequest& request);

}  // namespace fluxfarm
