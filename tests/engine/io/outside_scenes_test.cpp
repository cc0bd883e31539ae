// Scenes that others wrote, found through FLUXFARM_SCENES_DATA (default ../shared/scenes-data beside the repository).
#include <algorithm>
#include <cstdlib>

#include "io/scene_folder.h"

namespace fluxfarm {
namespace {

std::filesystem::path scenes_data() {
  if (const char* folder = std::getenv("FLUXFARM_SCENES_DATA")) return folder;
  return std::filesystem::path(__FILE__).parent_path() / "../../../../shared/scenes-data";
}

class OutsideScenes : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::is_directory(scenes_data()))
      GTEST_SKIP() << "no outside scenes: set FLUXFARM_SCENES_DATA to their folder";
  }
  static SceneDescription read(const std::string& name) { return read_scene(scenes_data() / name, "scene.xml"); }
  static std::size_t triangles(const SceneDescription& scene) {
    std::size_t count = 0;
    for (const ShapeDescription& shape : scene.shapes) {
      if (const auto* mesh = std::get_if<MeshDescription>(&shape.geometry)) count += mesh->indices.size() / 3;
    }
    return count;
  }
};

TEST_F(OutsideScenes, CornellBoxLoads) {
  const SceneDescription scene = read("cornell-box");
  EXPECT_EQ(scene.shapes.size(), 8u);
  EXPECT_EQ(scene.method.max_depth, 30);
  EXPECT_EQ(scene.film.filter.kind, PixelFilterKind::kTent);
  EXPECT_EQ(scene.shapes.back().emitted_radiance, Rgb(17, 12, 4));
  EXPECT_TRUE(scene.warnings.empty());
}

TEST_F(OutsideScenes, VeachMisLoads) {
  const SceneDescription scene = read("veach-mis");
  EXPECT_EQ(scene.shapes.size(), 9u);
  EXPECT_EQ(scene.film.width, 1280);
}

TEST_F(OutsideScenes, VeachBidirLoads) {
  const SceneDescription scene = read("veach-bidir");
  EXPECT_EQ(scene.shapes.size(), 14u);
  EXPECT_EQ(triangles(scene), 11540u);  // as Mitsuba counts them
}

TEST_F(OutsideScenes, WaterCausticWithOldSpellingsLoads) {
  const SceneDescription scene = read("water-caustic");
  EXPECT_EQ(scene.method.max_depth, 32);
  EXPECT_EQ(triangles(scene), 12u + 12 + 102938 + 513);
}

TEST_F(OutsideScenes, VeachAjarLoadsItsTextures) {
  const SceneDescription scene = read("veach-ajar");
  ASSERT_EQ(scene.textures.size(), 4u);
  EXPECT_EQ(std::count_if(scene.textures.begin(), scene.textures.end(),
                          [](const TextureDescription& texture) { return std::holds_alternative<BitmapDescription>(texture); }),
            3);
}

TEST_F(OutsideScenes, GlassOfMilk) {
  const SceneDescription scene = read("glass-of-milk");
  EXPECT_EQ(scene.media.size(), 1u);
  EXPECT_TRUE(std::ranges::any_of(
      scene.materials, [](const MaterialDescription& material) { return std::holds_alternative<BlendDescription>(material); }));
}

}  // namespace
}  // namespace fluxfarm
