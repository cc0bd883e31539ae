// A folder of scene files under testing::TempDir() that a test fills and reads, and the error texts that come out of it.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "io/scene_reader.h"
#include "support/error.h"

namespace fluxfarm {

class SceneFolder {
 public:
  SceneFolder() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path_ =
        std::filesystem::path(testing::TempDir()) / ("fluxfarm-io-" + std::string(test->test_suite_name()) + "-" + test->name());
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~SceneFolder() { std::filesystem::remove_all(path_); }

  void write(const std::string& name, const std::string& bytes) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << bytes;
  }

  // A scene with a sensor and a light around `body`, which starts on line 2.
  SceneDescription read_xml(const std::string& body, const SceneOverrides& overrides = {}) const {
    write("scene.xml",
          "<scene version=\"3.0.0\"><sensor type=\"perspective\"/><emitter type=\"constant\"/>\n" + body + "\n</scene>\n");
    return read_scene(path_, "scene.xml", overrides);
  }
  SceneDescription read_whole_xml(const std::string& text, const SceneOverrides& overrides = {}) const {
    write("scene.xml", text);
    return read_scene(path_, "scene.xml", overrides);
  }
  SceneDescription read_json(const std::string& text) const {
    write("scene.json", text);
    return read_scene(path_, "scene.json", {});
  }

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// The text of the SceneError that `read` throws; a failure if it throws none.
template <typename Read>
std::string error_of(const Read& read) {
  try {
    read();
  } catch (const SceneError& error) {
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "another kind of error: " << error.what();
    return "";
  }
  ADD_FAILURE() << "no error";
  return "";
}

// The mesh of the only shape.
inline const MeshDescription& only_mesh(const SceneDescription& scene) {
  EXPECT_EQ(scene.shapes.size(), 1u);
  return std::get<MeshDescription>(scene.shapes.at(0).geometry);
}

}  // namespace fluxfarm
