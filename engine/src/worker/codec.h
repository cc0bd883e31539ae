// Plain structs to and from the bytes of proto/fluxfarm/v1. The only file, with its .cpp, that sees generated code.
#pragma once

#include <string>
#include <string_view>

#include "film/tile_sums.h"
#include "worker/messages.h"

namespace fluxfarm {

// Throws Error when the bytes are not a Request.
Request decode_request(std::string_view bytes);
std::string encode_reply(std::uint64_t request_id, const ReplyBody& body);

// A tile's sums as they lie on disk between a RenderTiles and a MergePass.
std::string encode_tile_sums(const TileSums& sums);
// Throws ResourceError when the bytes are not a TileSums or contradict themselves; `where` names them.
TileSums decode_tile_sums(std::string_view bytes, const std::string& where);

}  // namespace fluxfarm
