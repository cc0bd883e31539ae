// Carries out MergePass and WriteTile: from film and tile files to films and images.
#pragma once

#include "worker/messages.h"

namespace fluxfarm {

// Throws ResourceError when a file cannot be read or written, Error when tiles do not follow the film.
FilmSummary merge_pass(const MergePassRequest& request);
void write_tile(const WriteTileRequest& request);

}  // namespace fluxfarm
