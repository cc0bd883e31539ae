// Every plugin and every parameter that the readers know stands in engine/src/io/README.md.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>

namespace fluxfarm {
namespace {

std::string text_of(const std::filesystem::path& path) {
  std::ifstream stream(path);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// All first groups of the matches in the text.
std::set<std::string> matches(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::set<std::string> result;
  for (std::sregex_iterator it(text.begin(), text.end(), regex), end; it != end; ++it) result.insert((*it)[1]);
  return result;
}

TEST(Readme, NamesEveryPluginAndParameter) {
  const std::filesystem::path room = std::filesystem::path(__FILE__).parent_path() / "../../../engine/src/io";
  const std::string readme = text_of(room / "README.md");
  std::set<std::string> names = matches(text_of(room / "plugin_tree.cpp"), "\\{\"(\\w+)\", PluginKind::k(?!Unsupported|Reference)");
  EXPECT_GT(names.size(), 30u);
  for (const char* file :
       {"read_film.cpp", "read_sensor.cpp", "read_material.cpp", "read_principled.cpp", "read_nested_material.cpp",
        "read_texture.cpp", "read_emitter.cpp", "read_shape.cpp", "read_medium.cpp"}) {
    const std::string code = text_of(room / file);
    names.merge(matches(code, "properties\\.(?:boolean|integer|number|text|triple|transform|rgb|emission|has)\\(\"(\\w+)\""));
    names.merge(matches(code, "\"([a-z]+_[a-z_]+)\""));
  }
  EXPECT_GT(names.size(), 80u);
  for (const std::string& name : names) {
    EXPECT_NE(readme.find("`" + name + "`"), std::string::npos) << name << " is missing in engine/src/io/README.md";
  }
}

}  // namespace
}  // namespace fluxfarm
