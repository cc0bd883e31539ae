// The worker's pieces: tiles, codec, frames, and the real process over a socket pair.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>

#include "film/tile_grid.h"
#include "support/error.h"
#include "support/scene_builder.h"
#include "support/sky.h"
#include "worker/codec.h"
#include "worker/frame_socket.h"
#include "worker/tile_file.h"
#include "worker/tile_runner.h"

namespace fluxfarm::testing {
namespace {

namespace fs = std::filesystem;

SceneDescription small_scene() {
  SceneBuilder scene;
  scene.floor(0, 4, scene.diffuse(0.7f));
  scene.lamp_down(0.3f, 2, 0, 1, 1, scene.diffuse(0), 4);
  scene.shape(SphereDescription{{0, 0.5f, 0}, 0.5f}, scene.add(DielectricDescription{}));
  scene.look({0, 1.5, -4}, {0, 0.4, 0});
  SceneDescription description = scene.description();
  description.camera.fov_degrees = 40;
  description.film.width = 33;
  description.film.height = 21;
  return description;
}

// The same with every light that has no shape, through a lens.
SceneDescription scene_lit_from_outside() {
  SceneDescription description = small_scene();
  description.camera.aperture_radius = 0.1f;
  description.camera.focus_distance = 3;
  description.emitters = {EnvmapEmitterDescription{patchy_sky(16, 11), Transform()}, ConstantEmitterDescription{Rgb{0.1f}},
                          DirectionalEmitterDescription{{0, -1, 0}, Rgb{1.0f}},
                          SpotEmitterDescription{{1, 2, 0}, {0, -1, 0}, Rgb{2.0f}, 40, 30},
                          PointEmitterDescription{{-1, 1, 0}, Rgb{1.0f}}};
  return description;
}

Film render(const SceneDescription& description, std::uint32_t spp, int tile, int threads) {
  const Scene scene(description, 1);
  const auto integrator = make_integrator("path", scene);
  const std::atomic<bool> never{false};
  return render_frame(scene, *integrator, {{0, 0, 33, 21}, tile, threads, 5, {spp, {}, {}}}, never).film;
}

TEST(FrameRenderer, FrameIsIdenticalForAnyTileSizeAndNumberOfThreads) {
  for (const SceneDescription& description : {small_scene(), scene_lit_from_outside()}) {
    const Image reference = render(description, 52, 64, 1).image({0, 0, 33, 21}, {});
    for (const auto& [tile, threads] : {std::pair{16, 2}, std::pair{5, 3}, std::pair{1, 1}}) {
      const Image other = render(description, 52, tile, threads).image({0, 0, 33, 21}, {});
      for (std::size_t c = 0; c < reference.channels.size(); ++c) {
        EXPECT_EQ(reference.channels[c].values, other.channels[c].values) << reference.channels[c].name << ", tiles of " << tile;
      }
    }
  }
}

TEST(FrameRenderer, StopsNearItsTimeAndReportsEachPass) {
  const Scene scene(small_scene(), 1);
  const auto integrator = make_integrator("path", scene);
  const std::atomic<bool> never{false};
  int passes = 0;
  const FrameResult result =
      render_frame(scene, *integrator, {{0, 0, 33, 21}, 16, 1, 5, {{}, 0.5, {}}}, never, [&](const TimelinePoint&) { ++passes; });
  EXPECT_GT(result.seconds, 0.3);
  EXPECT_LT(result.seconds, 1.0);
  EXPECT_EQ(static_cast<std::size_t>(passes), result.timeline.size());
  EXPECT_EQ(result.summary.max_samples, result.timeline.back().spp);
}

// Takes 0.2 s and 1000 rays before its first sample, and `growth` times as many before its fifth.
class WithLevels final : public Integrator {
 public:
  explicit WithLevels(double growth) : growth_(growth) {}
  const char* name() const override { return "with levels"; }
  void prepare(const Scene&) override {}
  double growth_at(SampleRange samples) const override { return samples.begin == 4 ? growth_ : 0; }
  std::shared_ptr<const PreparedPass> prepare_pass(std::uint64_t, SampleRange samples, int,
                                                   const std::atomic<bool>&) const override {
    struct Rays : PreparedPass {
      explicit Rays(std::uint64_t traced) : count(traced) {}
      std::uint64_t rays() const override { return count; }
      std::uint64_t count;
    };
    if (samples.begin == 0) std::this_thread::sleep_for(std::chrono::milliseconds(200));
    second_level |= samples.begin == 4;
    return std::make_shared<Rays>(samples.begin == 0 ? 1000 : 0);
  }
  void radiance(std::span<const CameraSample>, std::uint64_t, const PreparedPass*, std::span<SampleResult> results,
                RayQueries&) const override {
    std::ranges::fill(results, SampleResult{});
  }

  mutable bool second_level = false;

 private:
  double growth_;
};

TEST(FrameRenderer, BeginsNoLevelThatDoesNotFitIntoItsTime) {
  const Scene scene(small_scene(), 1);
  const std::atomic<bool> never{false};
  for (const auto& [growth, fits] : {std::pair{0.1, true}, {4.0, false}}) {
    const WithLevels integrator(growth);
    const FrameResult result = render_frame(scene, integrator, {{0, 0, 33, 21}, 16, 1, 5, {{}, 0.8, {}}}, never);
    EXPECT_EQ(integrator.second_level, fits) << growth;
    EXPECT_EQ(result.summary.max_samples > 4, fits) << growth;
  }
}

TEST(FrameRenderer, ErrorGoalIsReachedByTheBoundAndNotBefore) {
  const Scene scene(small_scene(), 1);
  const auto integrator = make_integrator("path", scene);
  const std::atomic<bool> never{false};
  FrameResult result = render_frame(scene, *integrator, {{0, 0, 33, 21}, 16, 1, 5, {{}, {}, 0.2}}, never);
  ASSERT_GE(result.timeline.size(), 2u);
  EXPECT_LE(*result.timeline.back().error_bound, 0.2);
  result.timeline.pop_back();
  for (const TimelinePoint& before : result.timeline) EXPECT_TRUE(!before.error_bound || *before.error_bound > 0.2) << before.spp;
}

// A batch of some hundred samples takes milliseconds, so ending at the next one is well within 0.2 s. Counted in batches and not in
// seconds, which a loaded machine stretches.
TEST(TileRunner, EndsWithTheBatchInWhichItWasCancelled) {
  const Scene scene(small_scene(), 1);
  const auto integrator = make_integrator("path", scene);
  RayQueries queries(scene.accelerator());
  std::atomic<bool> cancelled{false};
  int batches = 0;
  std::uint64_t largest = 0;
  const auto progress = [&](std::uint64_t samples) {
    largest = std::max(largest, samples);
    cancelled = ++batches == 3;
  };
  EXPECT_THROW(render_tile(scene, *integrator, {{0, 0, 33, 21}, {0, 64}, 0}, queries, cancelled, progress), CancelledError);
  EXPECT_EQ(batches, 3);
  EXPECT_LE(largest, 512u);
}

TEST(TileRunner, ATileAtAnOddPlaceIsThatPartOfTheFrame) {
  const Scene scene(small_scene(), 1);
  const auto integrator = make_integrator("path", scene);
  RayQueries queries(scene.accelerator());
  const std::atomic<bool> never{false};
  const PixelRect frame{0, 0, 33, 21}, tile{3, 4, 7, 5};
  for (const SampleRange samples : {SampleRange{0, 1}, {2, 4}, {16, 32}}) {
    const TileSums whole = render_tile(scene, *integrator, {frame, samples, 9}, queries, never);
    const TileSums part = render_tile(scene, *integrator, {tile, samples, 9}, queries, never);
    const std::size_t values = part.replicates() * 3;
    for (int y = 0; y < tile.height; ++y) {
      for (int x = 0; x < tile.width; ++x) {
        const std::size_t here = (static_cast<std::size_t>(y) * tile.width + x) * values;
        const std::size_t there = (static_cast<std::size_t>(tile.y + y) * frame.width + tile.x + x) * values;
        for (std::size_t i = 0; i < values; ++i) EXPECT_EQ(part.radiance[here + i], whole.radiance[there + i]);
      }
    }
  }
}

TEST(TileRunner, TilesCoverTheImageExactlyOnce) {
  std::vector<int> covered(33 * 21);
  for (const PixelRect& tile : make_tiles({0, 0, 33, 21}, 8)) {
    for (int y = tile.y; y < tile.y + tile.height; ++y) {
      for (int x = tile.x; x < tile.x + tile.width; ++x) ++covered[static_cast<std::size_t>(y * 33 + x)];
    }
  }
  EXPECT_EQ(covered, std::vector<int>(33 * 21, 1));
}

TEST(Codec, TileSumsSurviveTheWire) {
  const Scene scene(small_scene(), 1);
  const auto integrator = make_integrator("path", scene);
  RayQueries queries(scene.accelerator());
  const std::atomic<bool> never{false};
  const TileSums sums = render_tile(scene, *integrator, {{3, 4, 7, 5}, {2, 4}, 9}, queries, never);
  const TileSums back = decode_tile_sums(encode_tile_sums(sums), "here");
  EXPECT_EQ(sums.radiance, back.radiance);
  EXPECT_EQ(sums.features, back.features);
  EXPECT_EQ(sums.layers, back.layers);
  EXPECT_EQ(sums.layers.size(), 4u);
  EXPECT_EQ(sums.layer_sums, back.layer_sums);
  EXPECT_EQ(sums.rect, back.rect);
  EXPECT_EQ(sums.samples, back.samples);
  EXPECT_EQ(sums.seed, back.seed);
}

// Copying no numbers was undefined behaviour, as the sanitizer saw.
TEST(Codec, TileSumsWithoutLayersAndBiasSurviveTheWire) {
  const TileSums sums{{0, 0, 2, 2}, {0, 1}, 0, std::vector<float>(12, 0.5f), std::vector<float>(32, 0.25f), 0};
  const TileSums back = decode_tile_sums(encode_tile_sums(sums), "here");
  EXPECT_EQ(back.radiance, sums.radiance);
  EXPECT_EQ(back.layers.size(), 0u);
  EXPECT_TRUE(back.layer_sums.empty());
  EXPECT_FALSE(back.biased);
  EXPECT_TRUE(back.bias_sums.empty());
}

TEST(Codec, DamagedTileSumsAreAnError) {
  const std::string bytes = encode_tile_sums({{0, 0, 2, 2}, {0, 1}, 0, std::vector<float>(12), std::vector<float>(32), 0});
  EXPECT_NO_THROW(decode_tile_sums(bytes, "here"));
  EXPECT_THROW(decode_tile_sums(bytes.substr(0, bytes.size() - 9), "here"), ResourceError);
  EXPECT_THROW(decode_tile_sums("nonsense", "here"), ResourceError);
  EXPECT_THROW(
      decode_tile_sums(encode_tile_sums({{0, 0, 2, 2}, {0, 1}, 0, std::vector<float>(11), std::vector<float>(32), 0}), "here"),
      ResourceError);
  const LightLayers one = LightLayers().insert(LightLayer::kDirect);
  EXPECT_THROW(decode_tile_sums(
                   encode_tile_sums(
                       {{0, 0, 2, 2}, {0, 1}, 0, std::vector<float>(12), std::vector<float>(32), 0, one, std::vector<float>(11)}),
                   "here"),
               ResourceError);
}

class TileFile : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  const fs::path folder_ = fs::path(::testing::TempDir()) / ("tile-file-" + std::to_string(::getpid()));
  const TileSums sums_{{0, 0, 2, 2}, {0, 1}, 7, std::vector<float>(12, 0.5f), std::vector<float>(32, 0.25f), 1};
};

TEST_F(TileFile, GivesBackTheSumsAndSaysItsLength) {
  const fs::path path = folder_ / "1-0.tile";
  const std::uint64_t bytes = write_tile_file(path, sums_);
  EXPECT_EQ(bytes, fs::file_size(path));
  const TileSums back = read_tile_file(path);
  EXPECT_EQ(sums_.radiance, back.radiance);
  EXPECT_EQ(sums_.seed, back.seed);
}

TEST_F(TileFile, ThatCannotBeWrittenIsAnErrorAndLeavesNothing) {
  EXPECT_THROW(write_tile_file(folder_ / "absent" / "1-0.tile", sums_), ResourceError);
  const fs::path full = folder_ / "1-1.tile";
  fs::create_symlink("/dev/full", full);  // each write to it says that the disk is full
  try {
    write_tile_file(full, sums_);
    FAIL() << "written to a full disk";
  } catch (const ResourceError& error) {
    EXPECT_NE(std::string(error.what()).find("1-1.tile: cannot write the tile, is the disk full?"), std::string::npos);
  }
  EXPECT_FALSE(fs::is_symlink(full));
}

TEST(FrameSocket, RefusesFramesThatAreTooLongAndEndsAtEndOfFile) {
  int fds[2];
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, fds), 0);
  FrameSocket a(fds[0]), b(fds[1]);
  EXPECT_TRUE(a.write("hello"));
  EXPECT_EQ(b.read(), "hello");
  const unsigned char too_long[4] = {0, 0, 0, 0x7f};
  ASSERT_EQ(write(fds[0], too_long, 4), 4);
  EXPECT_THROW(b.read(), Error);
  close(fds[0]);
  EXPECT_EQ(b.read(), std::nullopt);
  close(fds[1]);
}

}  // namespace
}  // namespace fluxfarm::testing
