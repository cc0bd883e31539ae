#include "worker/codec.h"

#include <fluxfarm/v1/engine.pb.h>
#include <unistd.h>

#include <bit>
#include <cstring>

#include "support/error.h"

namespace fluxfarm {
namespace {

static_assert(std::endian::native == std::endian::little, "sums travel as the memory of a little-endian machine");

PixelRect decode(const v1::PixelRect& rect) {
  return {static_cast<int>(rect.x()), static_cast<int>(rect.y()), static_cast<int>(rect.width()), static_cast<int>(rect.height())};
}

void encode(PixelRect rect, v1::PixelRect& out) {
  out.set_x(static_cast<std::uint32_t>(rect.x));
  out.set_y(static_cast<std::uint32_t>(rect.y));
  out.set_width(static_cast<std::uint32_t>(rect.width));
  out.set_height(static_cast<std::uint32_t>(rect.height));
}

ImageInfo decode(const v1::ImageInfo& info) { return {info.job(), info.scene_digest(), info.integrator(), "", info.seed()}; }

template <typename Files>
std::vector<std::filesystem::path> decode_paths(const Files& files) {
  std::vector<std::filesystem::path> paths;
  for (const v1::TileFile& file : files) paths.emplace_back(file.path());
  return paths;
}

LoadSceneRequest::Picture decode(const v1::Picture& m) {
  Goal goal;
  if (m.has_spp()) goal.spp = m.spp();
  if (m.has_seconds()) goal.seconds = m.seconds();
  if (m.has_rel_error()) goal.rel_error = m.rel_error();
  return {decode(m.crop()), m.seed(), goal};
}

LoadSceneRequest decode(const v1::LoadScene& m) {
  return {m.scene_key(),  m.folder(),         m.entry(), static_cast<int>(m.width()), static_cast<int>(m.height()),
          m.integrator(), decode(m.picture())};
}

RenderTilesRequest decode(const v1::RenderTiles& m) {
  RenderTilesRequest request{m.scene_key(), m.seed(), {m.samples().begin(), m.samples().end()}, {}, m.tiles_out()};
  for (const v1::PixelRect& tile : m.tiles()) request.tiles.push_back(decode(tile));
  return request;
}

MergePassRequest::Decision decode(const v1::ErrorGoal& m) {
  return {{m.rel_error(), m.most_samples()}, static_cast<int>(m.round()), m.scene_key()};
}

MergePassRequest decode(const v1::MergePass& m) {
  return {static_cast<int>(m.width()),
          static_cast<int>(m.height()),
          decode(m.crop()),
          m.film_in(),
          decode_paths(m.tiles()),
          m.film_out(),
          m.exr_out(),
          m.png_out(),
          decode(m.info()),
          m.has_error_goal() ? std::optional(decode(m.error_goal())) : std::nullopt};
}

WriteTileRequest decode(const v1::WriteTile& m) {
  return {static_cast<int>(m.width()),
          static_cast<int>(m.height()),
          decode(m.rect()),
          m.film_in(),
          decode_paths(m.tiles()),
          m.exr_out(),
          decode(m.info())};
}

void encode(const HelloReply& r, v1::Reply& out) {
  v1::Hello& m = *out.mutable_hello();
  m.set_protocol_version(kProtocolVersion);
  m.set_engine_build(r.engine_build);
  m.set_threads(static_cast<std::uint32_t>(r.threads));
  m.set_pid(static_cast<std::uint32_t>(getpid()));
  for (const std::string& missing : r.sandbox_missing) m.add_sandbox_missing(missing);
}

void encode(const SceneLoadedReply& r, v1::Reply& out) {
  v1::SceneLoaded& m = *out.mutable_scene_loaded();
  m.set_width(static_cast<std::uint32_t>(r.width));
  m.set_height(static_cast<std::uint32_t>(r.height));
  m.set_scene_spp(static_cast<std::uint32_t>(r.scene_spp));
  encode(r.crop, *m.mutable_crop());
  m.set_integrator(r.integrator);
  for (const std::string& warning : r.warnings) m.add_warnings(warning);
  m.set_seconds(r.seconds);
  m.set_plan_json(r.plan_json);
}

void encode(const ProgressReply& r, v1::Reply& out) { out.mutable_progress()->set_samples(r.samples); }

void encode(const TileDoneReply& r, v1::Reply& out) {
  v1::TileDone& m = *out.mutable_tile_done();
  m.set_tile(r.tile);
  m.set_bytes(r.bytes);
  m.set_seconds(r.seconds);
  m.set_rays(r.rays);
  m.set_non_finite_samples(r.non_finite_samples);
}

void encode(const TilesDoneReply&, v1::Reply& out) { out.mutable_tiles_done(); }

void encode(const ErrorLook& look, v1::PassMerged& out) {
  out.set_error_bound(look.bound);
  out.set_samples_expected(look.samples);
  if (look.unseen) out.set_error_unseen(*look.unseen);
  out.set_warning(look.warning);
  if (!look.next) return;
  v1::Round& round = *out.mutable_next_round();
  round.mutable_samples()->set_begin(look.next->samples.begin);
  round.mutable_samples()->set_end(look.next->samples.end);
  round.mutable_tiles()->Assign(look.next->tiles.begin(), look.next->tiles.end());
}

void encode(const PassMergedReply& r, v1::Reply& out) {
  v1::PassMerged& m = *out.mutable_pass_merged();
  m.set_min_samples(r.summary.min_samples);
  m.set_max_samples(r.summary.max_samples);
  m.set_mean_samples(r.summary.mean_samples);
  if (r.summary.error_noise) m.set_error_noise(*r.summary.error_noise);
  if (r.summary.error_bias) m.set_error_bias(*r.summary.error_bias);
  if (r.look) encode(*r.look, m);
  m.set_mean_r(r.summary.mean[0]);
  m.set_mean_g(r.summary.mean[1]);
  m.set_mean_b(r.summary.mean[2]);
  m.set_non_finite_samples(r.summary.non_finite_samples);
  m.set_seconds(r.seconds);
}

void encode(const TileWrittenReply&, v1::Reply& out) { out.mutable_tile_written(); }
void encode(const PongReply&, v1::Reply& out) { out.mutable_pong(); }

void encode(const FailureReply& r, v1::Reply& out) {
  v1::Failure& m = *out.mutable_failure();
  switch (r.kind) {
    case FailureKind::kScene: m.set_kind(v1::FAILURE_KIND_SCENE); break;
    case FailureKind::kResource: m.set_kind(v1::FAILURE_KIND_RESOURCE); break;
    case FailureKind::kInternal: m.set_kind(v1::FAILURE_KIND_INTERNAL); break;
    case FailureKind::kCancelled: m.set_kind(v1::FAILURE_KIND_CANCELLED); break;
  }
  m.set_message(r.message);
}

std::string bytes_of(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

std::vector<float> floats_of(const std::string& bytes) {
  std::vector<float> values(bytes.size() / sizeof(float));
  if (values.empty()) return values;  // its data() is null, which memcpy may not get
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(float));
  return values;
}

}  // namespace

Request decode_request(std::string_view bytes) {
  v1::Request message;
  if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) throw Error("a frame is not a Request");
  Request request{message.request_id(), UnknownRequest{}};
  switch (message.body_case()) {
    case v1::Request::kLoadScene: request.body = decode(message.load_scene()); break;
    case v1::Request::kRenderTiles: request.body = decode(message.render_tiles()); break;
    case v1::Request::kMergePass: request.body = decode(message.merge_pass()); break;
    case v1::Request::kWriteTile: request.body = decode(message.write_tile()); break;
    case v1::Request::kCancel: request.body = CancelRequest{message.cancel().target_request_id()}; break;
    case v1::Request::kPing: request.body = PingRequest{}; break;
    case v1::Request::BODY_NOT_SET: break;
  }
  return request;
}

std::string encode_reply(std::uint64_t request_id, const ReplyBody& body) {
  v1::Reply message;
  message.set_request_id(request_id);
  std::visit([&](const auto& reply) { encode(reply, message); }, body);
  return message.SerializeAsString();
}

std::string encode_tile_sums(const TileSums& sums) {
  v1::TileSums message;
  encode(sums.rect, *message.mutable_rect());
  message.mutable_samples()->set_begin(sums.samples.begin);
  message.mutable_samples()->set_end(sums.samples.end);
  message.set_seed(sums.seed);
  message.set_radiance(bytes_of(sums.radiance));
  message.set_features(bytes_of(sums.features));
  message.set_non_finite_samples(sums.non_finite_samples);
  message.set_layers(sums.layers.bits());
  message.set_layer_sums(bytes_of(sums.layer_sums));
  message.set_biased(sums.biased);
  message.set_bias_sums(bytes_of(sums.bias_sums));
  return message.SerializeAsString();
}

TileSums decode_tile_sums(std::string_view bytes, const std::string& where) {
  v1::TileSums message;
  if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) throw ResourceError(where + ": not a tile's sums");
  TileSums sums{decode(message.rect()),
                {message.samples().begin(), message.samples().end()},
                message.seed(),
                floats_of(message.radiance()),
                floats_of(message.features()),
                message.non_finite_samples(),
                LightLayers(message.layers()),
                floats_of(message.layer_sums()),
                message.biased(),
                floats_of(message.bias_sums())};
  if (sums.rect.empty() || sums.samples.begin >= sums.samples.end || sums.radiance.size() != sums.radiance_size() ||
      sums.features.size() != sums.features_size() || sums.layers.bits() != message.layers() ||
      sums.layer_sums.size() != sums.layer_sums_size() || sums.bias_sums.size() != sums.bias_sums_size()) {
    throw ResourceError(where + ": the tile's sums contradict themselves");
  }
  return sums;
}

}  // namespace fluxfarm
