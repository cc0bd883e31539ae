// Merging passes in pieces, with and without film files on the way.
#include "worker/merge.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "support/error.h"
#include "worker/codec.h"

namespace fluxfarm::testing {
namespace {

namespace fs = std::filesystem;

class Merge : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  // The tile of one pass of a 3 x 2 frame, with sums that no other pass has.
  fs::path tile(SampleRange samples) const {
    TileSums sums{{0, 0, 3, 2}, samples, 1, {}, {}, 0, LightLayers().insert(LightLayer::kVolume), {}};
    for (std::size_t i = 0; i < sums.radiance_size(); ++i) sums.radiance.push_back(0.1f * static_cast<float>(i + samples.end));
    for (std::size_t i = 0; i < sums.features_size(); ++i) sums.features.push_back(0.3f * static_cast<float>(i + samples.begin));
    for (std::size_t i = 0; i < sums.layer_sums_size(); ++i) sums.layer_sums.push_back(0.7f * static_cast<float>(i + samples.end));
    const fs::path path = folder_ / ("pass-" + std::to_string(samples.begin) + "-" + std::to_string(samples.end));
    std::ofstream(path, std::ios::binary) << encode_tile_sums(sums);
    return path;
  }

  MergePassRequest request(std::vector<fs::path> tiles, const fs::path& film_in = {}, const fs::path& film_out = {}) const {
    return {3, 2, {0, 0, 3, 2}, film_in, std::move(tiles), film_out, folder_ / "image.exr", {}, {}, {}};
  }

  static std::string bytes(const fs::path& path) {
    std::ostringstream out;
    out << std::ifstream(path, std::ios::binary).rdbuf();
    return out.str();
  }

  const fs::path folder_ = fs::path(::testing::TempDir()) / ("merge-" + std::to_string(::getpid()));
};

TEST_F(Merge, InPiecesGivesTheFilmOfAllAtOnce) {
  const std::vector<fs::path> tiles = {tile({0, 1}), tile({1, 4}), tile({4, 12})};
  PassMerger at_once;
  at_once.merge(request(tiles, {}, folder_ / "at-once"));

  PassMerger pieces;
  pieces.merge(request({tiles[0]}));
  pieces.merge(request({tiles[0], tiles[1]}));
  EXPECT_EQ(pieces.merge(request(tiles, {}, folder_ / "pieces")).summary.min_samples, 12u);
  EXPECT_EQ(bytes(folder_ / "at-once"), bytes(folder_ / "pieces"));

  PassMerger by_file;
  by_file.merge(request({tiles[0]}, {}, folder_ / "first"));
  by_file.merge(request({tiles[1], tiles[2]}, folder_ / "first", folder_ / "by-file"));
  EXPECT_EQ(bytes(folder_ / "at-once"), bytes(folder_ / "by-file"));
}

TEST_F(Merge, ReadsOnlyTheTilesThatAreNewSinceTheLastMerge) {
  const std::vector<fs::path> tiles = {tile({0, 1}), tile({1, 4})};
  PassMerger merger;
  merger.merge(request({tiles[0]}));
  fs::remove(tiles[0]);
  EXPECT_EQ(merger.merge(request(tiles)).summary.min_samples, 4u);
}

TEST_F(Merge, ForgetsTheKeptFilmWhenTold) {
  const std::vector<fs::path> tiles = {tile({0, 1}), tile({1, 4})};
  PassMerger merger;
  merger.merge(request({tiles[0]}));
  merger.forget();
  fs::remove(tiles[0]);
  EXPECT_THROW(merger.merge(request(tiles)), ResourceError);
}

TEST_F(Merge, DecidesOnlyWhenAsked) {
  MergePassRequest plain = request({tile({0, 16})});
  PassMerger merger;
  EXPECT_FALSE(merger.merge(plain).look.has_value());
  plain.decision = {{1e-6}, 1, {}};
  const std::optional<ErrorLook> look = merger.merge(plain).look;
  ASSERT_TRUE(look.has_value());
  ASSERT_TRUE(look->next.has_value());
  EXPECT_EQ(look->next->samples, (SampleRange{16, 32}));
}

TEST_F(Merge, AnotherJobOrAFailureInBetweenReadsEverythingAgain) {
  const std::vector<fs::path> tiles = {tile({0, 1}), tile({1, 4})};
  PassMerger merger;
  merger.merge(request({tiles[0]}));
  merger.merge(request({tile({0, 2})}));  // another job
  EXPECT_EQ(merger.merge(request(tiles)).summary.min_samples, 4u);
  EXPECT_THROW(merger.merge(request({tiles[0], tiles[1], folder_ / "absent"})), ResourceError);
  EXPECT_EQ(merger.merge(request(tiles)).summary.min_samples, 4u);
}

}  // namespace
}  // namespace fluxfarm::testing
