// The worker's protocol as plain structs: what requests ask and what replies say, without any generated code.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "film/error_goal.h"
#include "film/film.h"
#include "film/goal.h"
#include "film/pixel_rect.h"

namespace fluxfarm {

inline constexpr std::uint32_t kProtocolVersion = 6;

// ---------------------------------------------------------------- requests

// Names a scene with its settings, as it is kept between requests.
using SceneKey = std::string;

struct LoadSceneRequest {
  SceneKey key;
  std::filesystem::path folder, entry;
  int width = 0, height = 0;  // 0: as the scene says
  std::string integrator;     // "": as the scene says; "auto": for the picture that follows
  struct Picture {
    PixelRect crop;  // empty: as the scene says
    std::uint64_t seed = 0;
    Goal goal;  // none: as the scene says
  } picture;
};

struct RenderTilesRequest {
  SceneKey key;
  std::uint64_t seed = 0;
  SampleRange samples;
  std::vector<PixelRect> tiles;
  std::string tiles_out;  // how the paths of the tiles' files begin

  std::filesystem::path file(std::uint32_t tile) const { return tiles_out + "-" + std::to_string(tile) + ".tile"; }
};

// Film in, tiles added in the given order, film and images out; empty paths are skipped.
struct MergePassRequest {
  int width = 0, height = 0;
  PixelRect crop;
  std::filesystem::path film_in;
  std::vector<std::filesystem::path> tiles;
  std::filesystem::path film_out, exr_out, png_out;
  ImageInfo info;
  // The decision that is due after these tiles, if any.
  struct Decision {
    ErrorGoal goal;
    int round = 1;
    SceneKey key;  // of the scene that the tiles show, for its audit
  };
  std::optional<Decision> decision;
};

struct WriteTileRequest {
  int width = 0, height = 0;
  PixelRect rect;
  std::filesystem::path film_in;
  std::vector<std::filesystem::path> tiles;
  std::filesystem::path exr_out;
  ImageInfo info;
};

struct CancelRequest {
  std::uint64_t target = 0;
};

struct PingRequest {};

// The peer sent something that this version does not know.
struct UnknownRequest {};

struct Request {
  std::uint64_t id = 0;
  std::variant<UnknownRequest, LoadSceneRequest, RenderTilesRequest, MergePassRequest, WriteTileRequest, CancelRequest, PingRequest>
      body;
};

// ---------------------------------------------------------------- replies

struct HelloReply {
  std::string engine_build;
  int threads = 1;
  std::vector<std::string> sandbox_missing;  // of enter_sandbox
};

struct SceneLoadedReply {
  int width = 0, height = 0;
  int scene_spp = 0;
  PixelRect crop;
  std::string integrator;
  std::vector<std::string> warnings;
  double seconds = 0;
  std::string plan_json;
};

struct ProgressReply {
  std::uint64_t samples = 0;
};

struct TileDoneReply {
  std::uint32_t tile = 0;
  std::uint64_t bytes = 0;  // of its file
  double seconds = 0;
  std::uint64_t rays = 0, non_finite_samples = 0;
};

struct TilesDoneReply {};

struct PassMergedReply {
  FilmSummary summary;
  std::optional<ErrorLook> look;  // if a decision was due
  double seconds = 0;
};

struct TileWrittenReply {};
struct PongReply {};

enum class FailureKind { kScene, kResource, kInternal, kCancelled };

struct FailureReply {
  FailureKind kind = FailureKind::kInternal;
  std::string message;
};

using ReplyBody = std::variant<HelloReply, SceneLoadedReply, ProgressReply, TileDoneReply, TilesDoneReply, PassMergedReply,
                               TileWrittenReply, PongReply, FailureReply>;

}  // namespace fluxfarm
