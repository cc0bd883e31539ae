// Builds small glTF documents for tests: elements go into one buffer, everything else is JSON text that the test writes.
#pragma once

#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "io/scene_folder.h"

namespace fluxfarm {

class GltfBuilder {
 public:
  // Appends an accessor over its own bytes; returns its index. `extra` is more JSON of the accessor: ", \"normalized\": true".
  template <typename Component>
  int accessor(const std::vector<Component>& values, int components, const std::string& extra = "") {
    const int view = bytes(std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Component)));
    return raw_accessor("\"bufferView\": " + std::to_string(view) + ", \"componentType\": " + std::to_string(type_of(Component{})) +
                        ", \"count\": " + std::to_string(values.size() / static_cast<std::size_t>(components)) + ", \"type\": \"" +
                        (components == 1 ? "SCALAR" : "VEC" + std::to_string(components)) + "\"" + extra);
  }
  int raw_accessor(const std::string& members) {
    add("accessors", "{" + members + "}");
    return accessors_++;
  }
  // A buffer view over those bytes; returns its index.
  int bytes(const std::string& data, const std::string& extra = "") {
    add("bufferViews", "{\"buffer\": 0, \"byteOffset\": " + std::to_string(binary_.size()) +
                           ", \"byteLength\": " + std::to_string(data.size()) + extra + "}");
    binary_ += data;
    binary_.resize((binary_.size() + 3) / 4 * 4, '\0');
    return views_++;
  }
  GltfBuilder& add(const std::string& array, const std::string& element) {
    std::string& text = arrays_[array];
    text += (text.empty() ? "" : ", ") + element;
    return *this;
  }
  // More members of the document: ", \"extensionsUsed\": [...]".
  GltfBuilder& more(const std::string& members) {
    more_ += members;
    return *this;
  }

  // Unit square in z = 0 with normals and texture coordinates, as mesh 0 and node 0 with `node_members` more.
  GltfBuilder& square(const std::string& primitive_members = "", const std::string& node_members = "") {
    const int positions = accessor<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3);
    const int normals = accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
    const int uvs = accessor<float>({0, 1, 1, 1, 1, 0, 0, 0}, 2);
    const int indices = accessor<std::uint16_t>({0, 1, 2, 0, 2, 3}, 1);
    add("meshes", "{\"primitives\": [{\"attributes\": {\"POSITION\": " + std::to_string(positions) +
                      ", \"NORMAL\": " + std::to_string(normals) + ", \"TEXCOORD_0\": " + std::to_string(uvs) +
                      "}, \"indices\": " + std::to_string(indices) + primitive_members + "}]}");
    add("nodes", "{\"mesh\": 0" + node_members + "}");
    return *this;
  }

  std::string document(const std::string& buffer) const {
    std::string text = "{\"asset\": {\"version\": \"2.0\"}";
    for (const auto& [name, elements] : arrays_) text += ", \"" + name + "\": [" + elements + "]";
    if (!binary_.empty()) text += ", \"buffers\": [{" + buffer + "\"byteLength\": " + std::to_string(binary_.size()) + "}]";
    return text + more_ + "}";
  }
  const std::string& binary() const { return binary_; }

  // As text with a file for the buffer, read as a whole scene.
  SceneDescription read(const SceneFolder& folder) const {
    folder.write("parts/buffer 1.bin", binary_);
    folder.write("scene.gltf", document("\"uri\": \"parts/buffer%201.bin\", "));
    return read_scene(folder.path(), "scene.gltf", {});
  }
  // As .glb.
  std::string glb() const {
    std::string json = document("");
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string file = "glTF" + word(2) + word(static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + binary_.size()));
    return file + word(static_cast<std::uint32_t>(json.size())) + "JSON" + json + word(static_cast<std::uint32_t>(binary_.size())) +
           std::string("BIN\0", 4) + binary_;
  }
  static std::string word(std::uint32_t value) {
    std::string bytes(4, '\0');
    std::memcpy(bytes.data(), &value, 4);
    return bytes;
  }

 private:
  static int type_of(std::int8_t) { return 5120; }
  static int type_of(std::uint8_t) { return 5121; }
  static int type_of(std::int16_t) { return 5122; }
  static int type_of(std::uint16_t) { return 5123; }
  static int type_of(std::uint32_t) { return 5125; }
  static int type_of(float) { return 5126; }

  std::string binary_, more_;
  std::map<std::string, std::string> arrays_;
  int views_ = 0, accessors_ = 0;
};

// Whether one of the warnings has the text.
inline bool warns(const SceneDescription& scene, const std::string& text) {
  for (const std::string& warning : scene.warnings)
    if (warning.find(text) != std::string::npos) return true;
  return false;
}

}  // namespace fluxfarm
